// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/fastdds/names.hpp"

namespace eti::bus {

/// Larger datagrams are fragmented by IP, and one lost fragment loses the datagram. Headers and tunnel
/// overhead fit a common MTU of 1500 bytes beside this.
inline constexpr std::uint32_t max_datagram_bytes = 1400;  // [bytes]

/// Limit with an identity: certificate and permissions are sent in one datagram, which Fast DDS 2.9.1 cannot
/// fragment ("Cannot serialize ParticipantGenericMessage"). Messages sized for an MTU still fit it.
inline constexpr std::uint32_t max_secured_datagram_bytes = 8192;  // [bytes]

/// Ports of a domain (DDSI-RTPS 2.5, 9.6.2.3). Discovery and security have the even ones below those of
/// multicast topics, which begin above the first 45 participants'.
inline constexpr std::uint32_t first_port = 7400, ports_per_domain = 250, topic_ports_offset = 100;

/// Transports, peers and discovery server of a participant with these options, or those of a profile. Every
/// transport keeps to max_datagram_bytes. Adds to `warnings` what the kernel does not grant. Throws BusError
/// for contradictory options, a name that cannot be resolved, or an invalid profile.
[[nodiscard]] dds::DomainParticipantQos participant_qos(const Options& options,
                                                        std::vector<std::string>& warnings);

/// Whether these options find programs on this machine only; a profile defines it otherwise.
[[nodiscard]] bool this_machine_only(const Options& options);

/// IPv4 addresses of the interface that these options name, the only one to use; empty: all are. Throws
/// BusError if there is no such interface, or none is wanted because only this machine is reached.
[[nodiscard]] std::vector<std::string> only_addresses(const Options& options);

/// QoS of a discovery server; arguments as for DiscoveryServer.
[[nodiscard]] dds::DomainParticipantQos discovery_server_qos(int number, const std::string& address,
                                                             std::uint16_t port,
                                                             std::vector<std::string>& warnings);

/// The topic's own multicast group, where several readers receive one copy. Empty: these options do not use
/// multicast.
[[nodiscard]] std::optional<rtps::Locator_t> multicast_locator(const Options& options, std::size_t topic);

/// Discovery settings in terms of the command line: "this machine only" or "--peer a, --peer b".
[[nodiscard]] std::string reach(const Options& options);

}  // namespace eti::bus
