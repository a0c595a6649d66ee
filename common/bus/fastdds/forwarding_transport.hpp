// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "common/bus/fastdds/names.hpp"
#if ETI_FASTDDS >= 3
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#else
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#endif

namespace eti::bus {

/// A transport between the library and another transport. Sends whatever it is given; a derived class decides
/// what it receives.
class ForwardingTransport : public transport::ChainingTransport {
  public:
    using ChainingTransport::ChainingTransport;

#if ETI_FASTDDS >= 3
    bool send(rtps::SenderResource* sender, const std::vector<rtps::NetworkBuffer>& buffers,
              std::uint32_t total_bytes, rtps::LocatorsIterator* first, rtps::LocatorsIterator* end,
              const std::chrono::steady_clock::time_point& limit) final {
        return sender->send(buffers, total_bytes, first, end, limit);
    }
#else
    bool send(rtps::SenderResource* sender, const rtps::octet* buffer, std::uint32_t size,
              rtps::LocatorsIterator* first, rtps::LocatorsIterator* end,
              const std::chrono::steady_clock::time_point& limit) final {
        return sender->send(buffer, size, first, end, limit);
    }
#endif
};

}  // namespace eti::bus
