// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/bus/admission.hpp"

namespace eti::bus {

/// A participant's transports with a filter before their receivers: what is not bearable(), comes from a
/// writer that `admission` refuses, or says that its writer is further than it can be, never reaches the
/// library. Datagrams of `largest_datagram` bytes at most are sent. UDP and shared memory are known; throws
/// BusError on another kind, which names `profile`, the file that asked for it. When the library does not
/// come back from a datagram for `stuck_after`, the program says so and ends at once with the status
/// `stuck_status`.
void put_filter_before(
    std::vector<std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>>& transports,
    std::uint32_t largest_datagram, const std::shared_ptr<const Admission>& admission,
    const std::string& profile);

/// Longer than any that a sound session has; forces are gone after 0.3 s.
inline constexpr std::chrono::seconds stuck_after{30};
inline constexpr int stuck_status = 70;  // EX_SOFTWARE of sysexits.h

}  // namespace eti::bus
