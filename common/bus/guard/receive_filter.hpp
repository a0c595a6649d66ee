// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/bus/fastdds/names.hpp"
#include "common/bus/guard/admission.hpp"

namespace eti::bus {

/// Whence announcements come.
enum class Reach : std::uint8_t {
    this_machine,
    network,
    relayed,  ///< possibly by a discovery server, on behalf of others
};

/// Puts a filter before the receivers of a participant's transports. A datagram never reaches the library if
/// it is not is_well_formed(), comes from a writer that `admission` rejects, or carries an implausible
/// sequence number. Sent datagrams have at most max_datagram_bytes, or max_secured_datagram_bytes. Supports
/// UDP and shared memory; throws BusError on another kind, naming `profile`, the file that requested it.
/// Within this machine it drops what comes from another machine, since any program that joins the discovery
/// group on a network makes the kernel deliver that group's datagrams to every socket of the port, and
/// announcements that name addresses beyond this machine. With `only_addresses`, those of the one interface
/// to use, it drops what comes from elsewhere, and hides from the library the announced addresses to which
/// another interface leads. If `secured`, the library gets one datagram of discovery at a time: Fast
/// DDS 2.9.1 matches handshakes' endpoints through members that its threads share
/// (SecurityManager::match_builtin_endpoints), and two announcements at once left one of the participants
/// without them. When the library does not return from a datagram for `watchdog_timeout`, the program reports
/// that and ends at once with status `exit_watchdog`.
void install_receive_filter(std::vector<std::shared_ptr<transport::TransportDescriptorInterface>>& transports,
                            const std::shared_ptr<Admission>& admission, const std::string& profile,
                            Reach reach, const std::vector<std::string>& only_addresses, bool secured);

/// Longer than any stall of a working session; forces are zero after 0.3 s.
inline constexpr std::chrono::seconds watchdog_timeout{30};
inline constexpr int exit_watchdog = 70;  // EX_SOFTWARE of sysexits.h

}  // namespace eti::bus
