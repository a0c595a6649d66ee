// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/receive_filter.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/fastdds/forwarding_transport.hpp"
#include "common/bus/guard/announcement_guard.hpp"
#include "common/bus/guard/fragment_guard.hpp"
#include "common/bus/guard/interface_guard.hpp"
#include "common/bus/guard/rtps_message.hpp"
#include "common/bus/guard/sequence_number_guard.hpp"
#include "common/bus/library_log.hpp"
#include "common/bus/transport.hpp"
#include "common/process/log_throttle.hpp"
#include "common/process/watchdog.hpp"

namespace eti::bus {

namespace {

/// Descriptor of a chained transport: names the transport below it.
struct Chain final : transport::ChainingTransportDescriptor {
    using ChainingTransportDescriptor::ChainingTransportDescriptor;
    transport::TransportInterface* create_transport() const override {
        return low_level_descriptor->create_transport();
    }
};

/// Threads that wait for the library would wait forever, so the program cannot shut down in order.
void exit_on_watchdog() {
    bus_log().critical(
        "the DDS library has been processing one datagram for {} s: this program exits; forces have faded, "
        "and a session file keeps what was written. Start it again; if this recurs, hostile datagrams are "
        "being sent (docs/network.md)",
        watchdog_timeout.count());
    bus_log().flush();
    std::_Exit(exit_watchdog);
}

/// One per process, never destroyed: threads that the library leaves behind may still use it at exit, and
/// waiting for them in the destructor gave them time to use objects already destroyed.
Watchdog& watch() {
    static auto* const one =
        new Watchdog(std::chrono::seconds(1), static_cast<int>(watchdog_timeout.count()), exit_on_watchdog);
    return *one;
}

/// What the filters of one participant query.
struct Questions {
    std::shared_ptr<Admission> admission;
    std::shared_ptr<SequenceNumberGuard> reached = std::make_shared<SequenceNumberGuard>();
    std::shared_ptr<FragmentGuard> fragments = std::make_shared<FragmentGuard>();
    std::shared_ptr<AnnouncementGuard> announcements = std::make_shared<AnnouncementGuard>();
    std::shared_ptr<InterfaceGuard> interface = nullptr;  // none: all interfaces
    /// Held while the library processes what comes to a discovery port; null without security.
    std::shared_ptr<std::mutex> discovery = nullptr;
    bool this_machine_only = false, relayed = false;
    Watchdog* watch = &eti::bus::watch();
};

bool is_of_this_machine(const rtps::Locator_t& sender) {
    return sender.kind == LOCATOR_KIND_SHM ||
           (sender.kind == LOCATOR_KIND_UDPv4 && rtps::IPLocator::getIPv4(sender)[0] == 127);
}

bool comes_through(InterfaceGuard& interface, const rtps::Locator_t& sender) {
    InterfaceGuard::Address address{};
    if (sender.kind == LOCATOR_KIND_UDPv4) {
        std::copy_n(rtps::IPLocator::getIPv4(sender), address.size(), address.begin());
    }
    return sender.kind == LOCATOR_KIND_SHM ||
           (sender.kind == LOCATOR_KIND_UDPv4 && interface.leads_to(address));
}

/// Both are usual where other DDS programs run, and repeat every few seconds.
void say_once(std::atomic<bool>& said, const char* what, const char* why) {
    if (!said.exchange(true, std::memory_order_relaxed)) {
        bus_log().info("{}: ignored, as this program reaches {}", what, why);
    }
}

constexpr const char* machine = "this machine only (--network reaches others)";

void say_other_machine() {
    static std::atomic<bool> said{false};
    say_once(said, "DDS programs of other machines send to this domain", machine);
}

void say_other_interface() {
    static std::atomic<bool> said{false};
    say_once(said, "DDS programs of other networks send to this domain", "those of --interface only");
}

void say_other_addresses() {
    static std::atomic<bool> said{false};
    say_once(said, "a DDS program on this domain announces addresses beyond this machine", machine);
}

bool is_discovery_port(const rtps::Locator_t& local) {
    const std::uint32_t of_domain = (local.port - first_port) % ports_per_domain;
    return of_domain < topic_ports_offset && of_domain % 2 == 0;
}

std::vector<std::uint8_t> replaced(Bytes datagram, const std::vector<Replacement>& replacements) {
    std::vector<std::uint8_t> out(datagram.begin(), datagram.end());
    for (const Replacement& one : replacements) {
        std::ranges::copy(one.by, out.begin() + (one.place.data() - datagram.data()));
    }
    return out;
}

class ReceiveFilter final : public ForwardingTransport {
  public:
    ReceiveFilter(const std::shared_ptr<transport::TransportDescriptorInterface>& below, Questions ask)
        : ForwardingTransport(Chain(below)), below_(below), ask_(std::move(ask)) {}

    transport::TransportDescriptorInterface* get_configuration() override { return below_.get(); }

    void receive(transport::TransportReceiverInterface* next, const rtps::octet* buffer, std::uint32_t size,
                 const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
        if (ask_.this_machine_only && !is_of_this_machine(remote)) {
            say_other_machine();
            return;
        }
        if (ask_.interface && !comes_through(*ask_.interface, remote)) {
            say_other_interface();
            return;
        }
        std::string_view fault = "is not well-formed RTPS";
        bool ignored = false;
        std::vector<Replacement> replacements;
        const auto refused = [&](const WriterSubmessage& written) {
            ignored = ask_.admission->rejects(written.writer);
            if (ignored) {
                return true;
            }
            if (ask_.this_machine_only && !written.distant_locators.empty()) {
                say_other_addresses();
                ignored = true;  // not a fault of the datagram
                return true;
            }
            if (!ask_.relayed && written.announcement &&
                !ask_.announcements->plausible(written.writer.participant, *written.announcement)) {
                // Whoever leaves says so; nothing else that is refused here is usual.
                ignored = written.announcement->goodbye && !written.announcement->of_another;
                fault = "announces a participant otherwise than that one does";
                return true;
            }
            // Asked for few submessages only: it takes a lock.
            const auto from_owner = [&] { return ask_.admission->owner() == written.writer.participant; };
            if (written.up_to > 0 && !ask_.reached->plausible(written.writer, written.up_to, from_owner())) {
                fault = "claims more samples than its writer can have written";
                return true;
            }
            if (written.whole_sample > 0 &&
                !ask_.fragments->plausible(written.writer, written.whole_sample)) {
                fault = "is a whole sample of which fragments have come";
                return true;
            }
            if (written.fragments &&
                !ask_.reached->plausible(written.writer, written.fragments->sequence_number, from_owner())) {
                fault = "has fragments of a sample that its writer cannot have reached";
                return true;
            }
            if (written.fragments &&
                !ask_.fragments->plausible(written.writer, *written.fragments, from_owner())) {
                fault = "has fragments that do not belong together";
                return true;
            }
            replacements.insert(replacements.end(), written.replacements.begin(), written.replacements.end());
            for (const DistantLocator& one : written.distant_locators) {
                if (ask_.interface && (!one.address || !ask_.interface->leads_to(*one.address))) {
                    replacements.push_back({one.parameter, {0, 0}});  // PID_PAD
                }
            }
            return false;
        };
        if (is_well_formed({buffer, size}, refused)) {
            std::unique_lock<std::mutex> alone;
            if (ask_.discovery && is_discovery_port(local)) {
                alone = std::unique_lock(*ask_.discovery);
            }
            const Watchdog::Call call(*ask_.watch);
            if (replacements.empty()) {
                next->OnDataReceived(buffer, size, local, remote);
            } else {
                const auto copy = replaced({buffer, size}, replacements);
                next->OnDataReceived(copy.data(), size, local, remote);
            }
        } else if (!ignored) {
            log_dropped(size, fault);
        }
        ask_.admission->log_changes();
    }

  private:
    static void log_dropped(std::uint32_t size, std::string_view why) {
        static LogThrottle limit;
        if (const auto suppressed = limit.allow(why)) {
            bus_log().warn("a datagram of {} bytes that {} was dropped{}", size, why,
                           suppressed_suffix(*suppressed));
        }
    }

    std::shared_ptr<transport::TransportDescriptorInterface> below_;
    Questions ask_;
};

/// A descriptor type of its own, which the library requires.
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
            "{}: names a transport that is neither UDP nor shared memory; use one of these. This release of "
            "the DDS library crashes over TCP: a network that blocks UDP needs a tunnel (docs/network.md)",
            profile));
    }
    return out;
}

}  // namespace

void install_receive_filter(std::vector<std::shared_ptr<transport::TransportDescriptorInterface>>& transports,
                            const std::shared_ptr<Admission>& admission, const std::string& profile,
                            Reach reach, const std::vector<std::string>& only_addresses, bool secured) {
    Questions ask{admission};
    if (secured) {
        ask.discovery = std::make_shared<std::mutex>();
    }
    if (!only_addresses.empty()) {
        ask.interface = std::make_shared<InterfaceGuard>(only_addresses);
    }
    ask.this_machine_only = reach == Reach::this_machine;
    ask.relayed = reach == Reach::relayed;
    for (auto& one : transports) {
        one = filtered(one, secured ? max_secured_datagram_bytes : max_datagram_bytes, ask, profile);
    }
}

}  // namespace eti::bus
