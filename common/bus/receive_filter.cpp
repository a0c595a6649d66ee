// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/receive_filter.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/TCPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/TCPv6TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <algorithm>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/rtps_message.hpp"
#include "common/process/line_limit.hpp"

namespace eti::bus {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

/// What a chained transport is told: which one lies below it.
struct Chain final : transport::ChainingTransportDescriptor {
    using ChainingTransportDescriptor::ChainingTransportDescriptor;
    transport::TransportInterface* create_transport() const override {
        return low_level_descriptor->create_transport();
    }
};

class ReceiveFilter final : public transport::ChainingTransport {
  public:
    ReceiveFilter(const std::shared_ptr<transport::TransportDescriptorInterface>& below,
                  std::shared_ptr<const Admission> admission)
        : ChainingTransport(Chain(below)), below_(below), admission_(std::move(admission)) {}

    transport::TransportDescriptorInterface* get_configuration() override { return below_.get(); }

    bool send(rtps::SenderResource* sender, const rtps::octet* buffer, std::uint32_t size,
              rtps::LocatorsIterator* first, rtps::LocatorsIterator* end,
              const std::chrono::steady_clock::time_point& limit) override {
        return sender->send(buffer, size, first, end, limit);
    }

    void receive(transport::TransportReceiverInterface* next, const rtps::octet* buffer, std::uint32_t size,
                 const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
        bool by_admission = false;
        const auto refused = [&](const WriterId& writer) {
            return by_admission = admission_->refuses(writer);
        };
        if (bearable({buffer, size}, refused)) {
            next->OnDataReceived(buffer, size, local, remote);
        } else if (!by_admission) {
            say_unbearable(size);
        }
    }

  private:
    static void say_unbearable(std::uint32_t size) {
        static LineLimit limit;
        if (const auto kept_back = limit.allow("unbearable")) {
            bus_log().warn("a datagram of {} bytes that is not sound RTPS was dropped{}", size,
                           and_more(*kept_back));
        }
    }

    std::shared_ptr<transport::TransportDescriptorInterface> below_;
    std::shared_ptr<const Admission> admission_;
};

/// A descriptor of its own type, because the library asks for it.
template <class Descriptor>
struct Filtered final : Descriptor {
    Filtered(const Descriptor& below, std::shared_ptr<const Admission> who)
        : Descriptor(below), admission(std::move(who)) {}

    transport::TransportInterface* create_transport() const override {
        return new ReceiveFilter(std::make_shared<Descriptor>(*this), admission);
    }

    std::shared_ptr<const Admission> admission;
};

template <class Descriptor>
std::shared_ptr<transport::TransportDescriptorInterface> filtered_as(
    const transport::TransportDescriptorInterface& given, std::uint32_t largest,
    std::shared_ptr<const Admission> admission) {
    const auto* const known = dynamic_cast<const Descriptor*>(&given);
    if (known == nullptr) {
        return nullptr;
    }
    Descriptor below = *known;
    below.maxMessageSize = std::min(below.maxMessageSize, largest);
    return std::make_shared<Filtered<Descriptor>>(below, std::move(admission));
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> filtered(
    const std::shared_ptr<transport::TransportDescriptorInterface>& given, std::uint32_t largest_datagram,
    std::shared_ptr<const Admission> admission) {
    const auto as = [&]<class... Kinds>() {
        std::shared_ptr<transport::TransportDescriptorInterface> out;
        (void)((out = filtered_as<Kinds>(*given, largest_datagram, admission)) || ...);
        return out;
    };
    auto out =
        as.template operator()<transport::UDPv4TransportDescriptor, transport::SharedMemTransportDescriptor,
                               transport::UDPv6TransportDescriptor, transport::TCPv4TransportDescriptor,
                               transport::TCPv6TransportDescriptor>();
    if (!out) {
        throw BusError(
            "the profile names a transport that is neither UDP nor TCP nor shared memory; use one of these");
    }
    return out;
}

}  // namespace eti::bus
