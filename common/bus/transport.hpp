// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// Larger datagrams are cut by IP into fragments, of which one lost loses all; headers and what a tunnel adds
/// fit a common MTU of 1500 bytes beside this.
inline constexpr std::uint32_t largest_datagram = 1400;  // [bytes]

/// With an identity: certificate and permissions go in one datagram, which Fast DDS 2.9.1 cannot cut itself
/// ("Cannot serialize ParticipantGenericMessage"). Messages that were made to fit an MTU fit it still.
inline constexpr std::uint32_t largest_secured_datagram = 8192;  // [bytes]

/// How a participant of these options reaches the others: transports, peers, discovery server, or a
/// profile's. Every transport keeps to largest_datagram. Adds to `warnings` what the kernel does not grant.
/// Throws BusError: options that contradict each other, a name that no address is known of, a bad profile.
[[nodiscard]] eprosima::fastdds::dds::DomainParticipantQos participant_quality(
    const Options& options, std::vector<std::string>& warnings);

/// Of a discovery server, as DiscoveryServer has its arguments.
[[nodiscard]] eprosima::fastdds::dds::DomainParticipantQos discovery_server_quality(
    int number, const std::string& address, std::uint16_t port, std::vector<std::string>& warnings);

/// Where readers of a topic that several follow get one copy together: a multicast group of the topic's own.
/// Empty: these options reach nobody by multicast.
[[nodiscard]] std::optional<eprosima::fastrtps::rtps::Locator_t> shared_locator(const Options& options,
                                                                                std::size_t topic);

/// How others are looked for, in the words of the command line: "this machine alone" or "--peer a, --peer b".
[[nodiscard]] std::string reach(const Options& options);

}  // namespace eti::bus
