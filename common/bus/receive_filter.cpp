// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/receive_filter.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fmt/format.h>
#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/reached_numbers.hpp"
#include "common/bus/rtps_message.hpp"
#include "common/process/line_limit.hpp"
#include "common/process/stuck_watch.hpp"

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

/// Whoever waits for the library then waits for ever: no loop of the program can end it in order.
void end_stuck() {
    bus_log().critical(
        "the DDS library has not come back from a datagram for {} s: this program ends; forces "
        "faded when it fell silent, and a session file keeps what was written. Start it again; if "
        "this goes on, somebody sends hostile datagrams (docs/network.md)",
        stuck_after.count());
    bus_log().flush();
    std::_Exit(stuck_status);
}

/// Of the whole process, and never taken down: threads that the library leaves behind may still be in it as
/// the process ends, and waiting for it there gave them the time to use what was gone.
StuckWatch& watch() {
    static auto* const one =
        new StuckWatch(std::chrono::seconds(1), static_cast<int>(stuck_after.count()), end_stuck);
    return *one;
}

/// What the filters of one participant ask.
struct Questions {
    std::shared_ptr<const Admission> admission;
    std::shared_ptr<ReachedNumbers> reached = std::make_shared<ReachedNumbers>();
    StuckWatch* watch = &eti::bus::watch();
};

class ReceiveFilter final : public transport::ChainingTransport {
  public:
    ReceiveFilter(const std::shared_ptr<transport::TransportDescriptorInterface>& below, Questions ask)
        : ChainingTransport(Chain(below)), below_(below), ask_(std::move(ask)) {}

    transport::TransportDescriptorInterface* get_configuration() override { return below_.get(); }

    bool send(rtps::SenderResource* sender, const rtps::octet* buffer, std::uint32_t size,
              rtps::LocatorsIterator* first, rtps::LocatorsIterator* end,
              const std::chrono::steady_clock::time_point& limit) override {
        return sender->send(buffer, size, first, end, limit);
    }

    void receive(transport::TransportReceiverInterface* next, const rtps::octet* buffer, std::uint32_t size,
                 const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
        bool by_admission = false, leaps = false;
        const auto refused = [&](const Written& written) {
            by_admission = ask_.admission->refuses(written.writer);
            leaps =
                !by_admission && written.up_to > 0 && !ask_.reached->plausible(written.writer, written.up_to);
            return by_admission || leaps;
        };
        if (bearable({buffer, size}, refused)) {
            const StuckWatch::Call call(*ask_.watch);
            next->OnDataReceived(buffer, size, local, remote);
        } else if (!by_admission) {
            say_dropped(size, leaps ? "says of its writer more samples than it can have written"
                                    : "is not sound RTPS");
        }
    }

  private:
    static void say_dropped(std::uint32_t size, std::string_view why) {
        static LineLimit limit;
        if (const auto kept_back = limit.allow(why)) {
            bus_log().warn("a datagram of {} bytes that {} was dropped{}", size, why, and_more(*kept_back));
        }
    }

    std::shared_ptr<transport::TransportDescriptorInterface> below_;
    Questions ask_;
};

/// A descriptor of its own type, because the library asks for it.
template <class Descriptor>
struct Filtered final : Descriptor {
    Filtered(const Descriptor& below, Questions questions) : Descriptor(below), ask(std::move(questions)) {}

    transport::TransportInterface* create_transport() const override {
        return new ReceiveFilter(std::make_shared<Descriptor>(*this), ask);
    }

    Questions ask;
};

template <class Descriptor>
std::shared_ptr<transport::TransportDescriptorInterface> filtered_as(
    const transport::TransportDescriptorInterface& given, std::uint32_t largest, const Questions& ask) {
    const auto* const known = dynamic_cast<const Descriptor*>(&given);
    if (known == nullptr) {
        return nullptr;
    }
    Descriptor below = *known;
    below.maxMessageSize = std::min(below.maxMessageSize, largest);
    return std::make_shared<Filtered<Descriptor>>(below, ask);
}

std::shared_ptr<transport::TransportDescriptorInterface> filtered(
    const std::shared_ptr<transport::TransportDescriptorInterface>& given, std::uint32_t largest,
    const Questions& ask, const std::string& profile) {
    const auto as = [&]<class... Kinds>() {
        std::shared_ptr<transport::TransportDescriptorInterface> out;
        (void)((out = filtered_as<Kinds>(*given, largest, ask)) || ...);
        return out;
    };
    auto out =
        as.template operator()<transport::UDPv4TransportDescriptor, transport::SharedMemTransportDescriptor,
                               transport::UDPv6TransportDescriptor>();
    if (!out) {
        throw BusError(fmt::format(
            "{}: names a transport that is neither UDP nor shared memory; use one of these. Over "
            "TCP this release of the DDS library crashes: a network that lets no UDP through needs "
            "a tunnel for it (docs/network.md)",
            profile));
    }
    return out;
}

}  // namespace

void put_filter_before(std::vector<std::shared_ptr<transport::TransportDescriptorInterface>>& transports,
                       std::uint32_t largest_datagram, const std::shared_ptr<const Admission>& admission,
                       const std::string& profile) {
    const Questions ask{admission};
    for (auto& one : transports) {
        one = filtered(one, largest_datagram, ask, profile);
    }
}

}  // namespace eti::bus
