// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <memory>

#include "common/bus/admission.hpp"

namespace eti::bus {

/// The same transport with a filter before its receivers: what is not bearable(), or comes from a writer that
/// `admission` refuses, never reaches the library. Datagrams of `largest_datagram` bytes at most are sent.
/// UDP, TCP and shared memory are known; throws BusError on another kind.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> filtered(
    const std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>& transport,
    std::uint32_t largest_datagram, std::shared_ptr<const Admission> admission);

}  // namespace eti::bus
