// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "memory_network.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "common/bus/fastdds/transport_interface.hpp"

namespace eti::fuzz {

using bus::rtps::IPLocator;
using bus::rtps::Locator_t;
using bus::rtps::LocatorList_t;

MemoryNetwork& MemoryNetwork::instance() {
    static auto* const one = new MemoryNetwork;  // the library's threads outlive static objects
    return *one;
}

bool MemoryNetwork::open(std::uint16_t port, bool group, const void* owner, Receiver* receiver) {
    const std::lock_guard lock(mutex_);
    if (!group && ports_.contains(port)) {
        return false;
    }
    ports_.emplace(port, Port{owner, receiver, group});
    return true;
}

void MemoryNetwork::close(std::uint16_t port, const void* owner) {
    const std::lock_guard lock(mutex_);
    std::erase_if(ports_, [&](const auto& one) { return one.first == port && one.second.owner == owner; });
}

bool MemoryNetwork::is_open(std::uint16_t port, const void* owner) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(
        ports_, [&](const auto& one) { return one.first == port && one.second.owner == owner; });
}

std::vector<std::uint16_t> MemoryNetwork::unicast_ports() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::uint16_t> out;
    for (const auto& [number, port] : ports_) {
        if (!port.group) {
            out.push_back(number);
        }
    }
    return out;
}

void MemoryNetwork::send(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint16_t> ports) {
    const std::lock_guard lock(mutex_);
    if (keep_) {
        sent_.push_back({{bytes, bytes + size}, std::move(ports)});
    }
}

void MemoryNetwork::keep_sent(bool keep) {
    const std::lock_guard lock(mutex_);
    keep_ = keep;
    sent_.clear();
}

std::vector<MemoryNetwork::Sent> MemoryNetwork::take_sent() {
    const std::lock_guard lock(mutex_);
    return std::exchange(sent_, {});
}

void MemoryNetwork::deliver(std::uint16_t port, bus::Bytes datagram) {
    std::vector<Receiver*> receivers;
    {
        const std::lock_guard lock(mutex_);
        const auto [first, last] = ports_.equal_range(port);
        std::for_each(first, last, [&](const auto& one) { receivers.push_back(one.second.receiver); });
    }
    Locator_t local, remote;
    IPLocator::setIPv4(local, "10.0.0.1");
    local.port = port;
    IPLocator::setIPv4(remote, "10.0.0.2");
    remote.port = 7410;
    for (Receiver* const receiver : receivers) {
        const auto copy = std::make_unique<std::uint8_t[]>(datagram.size());
        std::ranges::copy(datagram, copy.get());
        receiver->OnDataReceived(copy.get(), static_cast<std::uint32_t>(datagram.size()), local, remote);
    }
}

namespace {

std::uint16_t port_of(const Locator_t& locator) {
    return IPLocator::getPhysicalPort(locator);
}

class MemorySender final : public bus::rtps::SenderResource {
  public:
    MemorySender() : SenderResource(LOCATOR_KIND_UDPv4) {
        send_lambda_ = [](const bus::rtps::octet* bytes, std::uint32_t size,
                          bus::rtps::LocatorsIterator* locator, bus::rtps::LocatorsIterator* end,
                          const std::chrono::steady_clock::time_point&) {
            std::vector<std::uint16_t> ports;
            for (; *locator != *end; ++*locator) {
                if ((**locator).kind == LOCATOR_KIND_UDPv4) {
                    ports.push_back(port_of(**locator));
                }
            }
            MemoryNetwork::instance().send(bytes, size, std::move(ports));
            return true;
        };
    }
};

/// Answers as UDPv4Transport does on a machine whose only address is its loopback.
class MemoryTransport final : public bus::transport::TransportInterface {
  public:
    explicit MemoryTransport(const bus::transport::UDPv4TransportDescriptor& configuration)
        : TransportInterface(LOCATOR_KIND_UDPv4), configuration_(configuration) {}

    bool init(const bus::rtps::PropertyPolicy*) override { return true; }
    bool IsInputChannelOpen(const Locator_t& locator) const override {
        return IsLocatorSupported(locator) && MemoryNetwork::instance().is_open(port_of(locator), this);
    }
    bool IsLocatorSupported(const Locator_t& locator) const override {
        return locator.kind == LOCATOR_KIND_UDPv4;
    }
    bool is_locator_allowed(const Locator_t& locator) const override { return IsLocatorSupported(locator); }
    Locator_t RemoteToMainLocal(const Locator_t& remote) const override {
        Locator_t local(remote);
        local.set_Invalid_Address();
        return local;
    }
    bool transform_remote_locator(const Locator_t& remote, Locator_t& result) const override {
        result = remote;
        return IsLocatorSupported(remote);
    }
    bool OpenOutputChannel(bus::transport::SendResourceList& senders, const Locator_t& locator) override {
        if (IsLocatorSupported(locator) && senders.empty()) {
            senders.push_back(std::make_unique<MemorySender>());
        }
        return IsLocatorSupported(locator);
    }
    bool OpenInputChannel(const Locator_t& locator, bus::transport::TransportReceiverInterface* receiver,
                          std::uint32_t) override {
        return MemoryNetwork::instance().open(port_of(locator), IPLocator::isMulticast(locator), this,
                                              receiver);
    }
    bool CloseInputChannel(const Locator_t& locator) override {
        MemoryNetwork::instance().close(port_of(locator), this);
        return true;
    }
    bool DoInputLocatorsMatch(const Locator_t& one, const Locator_t& other) const override {
        return port_of(one) == port_of(other);
    }
    LocatorList_t NormalizeLocator(const Locator_t& locator) override {
        LocatorList_t list;
        Locator_t one(locator);
        if (IPLocator::isAny(locator)) {
            IPLocator::setIPv4(one, "127.0.0.1");
        }
        list.push_back(one);
        return list;
    }
    void select_locators(bus::rtps::LocatorSelector& selector) const override {
        auto& entries = selector.transport_starts();
        for (std::size_t i = 0; i < entries.size(); ++i) {
            for (std::size_t j = 0; entries[i]->transport_should_process && j < entries[i]->unicast.size();
                 ++j) {
                if (IsLocatorSupported(entries[i]->unicast[j])) {
                    entries[i]->state.unicast.push_back(j);
                    selector.select(i);
                }
            }
        }
    }
    bool is_local_locator(const Locator_t& locator) const override { return IPLocator::isLocal(locator); }
    bus::transport::TransportDescriptorInterface* get_configuration() override { return &configuration_; }
    void AddDefaultOutputLocator(LocatorList_t& list) override {
        (void)getDefaultMetatrafficMulticastLocators(list, 0);
    }
    bool getDefaultMetatrafficMulticastLocators(LocatorList_t& list, std::uint32_t port) const override {
        Locator_t locator(LOCATOR_KIND_UDPv4, port);
        IPLocator::setIPv4(locator, "239.255.0.1");
        list.push_back(locator);
        return true;
    }
    bool getDefaultMetatrafficUnicastLocators(LocatorList_t& list, std::uint32_t port) const override {
        Locator_t locator(LOCATOR_KIND_UDPv4, port);
        locator.set_Invalid_Address();
        list.push_back(locator);
        return true;
    }
    bool getDefaultUnicastLocators(LocatorList_t& list, std::uint32_t port) const override {
        return getDefaultMetatrafficUnicastLocators(list, port);
    }
    bool fillMetatrafficMulticastLocator(Locator_t& locator, std::uint32_t port) const override {
        return fillUnicastLocator(locator, port);
    }
    bool fillMetatrafficUnicastLocator(Locator_t& locator, std::uint32_t port) const override {
        return fillUnicastLocator(locator, port);
    }
    bool configureInitialPeerLocator(Locator_t& locator, const bus::rtps::PortParameters& ports,
                                     std::uint32_t domain, LocatorList_t& list) const override {
        for (std::uint32_t i = 0; i < configuration_.maxInitialPeersRange && locator.port == 0; ++i) {
            Locator_t one(locator);
            one.port = ports.getUnicastPort(domain, i);
            list.push_back(one);
        }
        if (locator.port != 0) {
            list.push_back(locator);
        }
        return true;
    }
    bool fillUnicastLocator(Locator_t& locator, std::uint32_t port) const override {
        if (locator.port == 0) {
            locator.port = port;
        }
        return true;
    }
    std::uint32_t max_recv_buffer_size() const override { return 0xffff; }

  private:
    bus::transport::UDPv4TransportDescriptor configuration_;
};

}  // namespace

}  // namespace eti::fuzz

// Takes the place of the library's function of this name, in the library's own calls, too.
eprosima::fastdds::rtps::TransportInterface*
eprosima::fastdds::rtps::UDPv4TransportDescriptor::create_transport() const {
    return new eti::fuzz::MemoryTransport(*this);
}
