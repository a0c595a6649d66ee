// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/discovery/interface_watcher.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>

namespace eti::bus {

namespace {

Descriptor kernel_messages() {
    Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE));
    sockaddr_nl wanted{};
    wanted.nl_family = AF_NETLINK;
    wanted.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR;
    if (!socket || ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&wanted), sizeof wanted) != 0) {
        return {};
    }
    return socket;
}

/// Discards what has arrived; which messages they were does not matter.
void drain(int socket) {
    std::array<char, 8192> buffer{};
    while (::recv(socket, buffer.data(), buffer.size(), 0) > 0) {
    }
}

}  // namespace

std::vector<std::string> network_addresses() {
    std::vector<std::string> found;
    ifaddrs* list = nullptr;
    if (::getifaddrs(&list) != 0) {
        return found;
    }
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owned(list, &::freeifaddrs);
    for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
        // Without a carrier (a cable) nothing can be sent.
        constexpr unsigned usable = IFF_UP | IFF_RUNNING;
        if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET ||
            (one->ifa_flags & usable) != usable || (one->ifa_flags & IFF_LOOPBACK) != 0) {
            continue;
        }
        std::array<char, INET_ADDRSTRLEN> text{};
        ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr, text.data(),
                    text.size());
        found.push_back(std::string(one->ifa_name) + ' ' + text.data());
    }
    std::ranges::sort(found);
    return found;
}

InterfaceWatcher::InterfaceWatcher(std::function<void(const std::string&)> added)
    : added_(std::move(added)), kernel_(kernel_messages()), end_(::eventfd(0, EFD_CLOEXEC)) {
    known_ = network_addresses();
    if (kernel_ && end_) {
        thread_ = std::thread([this] { run(); });
    }
}

InterfaceWatcher::~InterfaceWatcher() {
    if (thread_.joinable()) {
        ::eventfd_write(end_.get(), 1);
        thread_.join();
    }
}

void InterfaceWatcher::run() {
    std::array<pollfd, 2> waiting{{{kernel_.get(), POLLIN, 0}, {end_.get(), POLLIN, 0}}};
    while (::poll(waiting.data(), waiting.size(), -1) < 0 || waiting[1].revents == 0) {
        if (waiting[0].revents == 0) {
            continue;
        }
        if (::poll(&waiting[1], 1, static_cast<int>(settling_time.count())) > 0) {
            return;
        }
        drain(kernel_.get());
        std::string added;
        for (const std::string& address : network_addresses()) {
            // One that returns, as after a cut cable, is used as before.
            if (std::ranges::find(known_, address) == known_.end()) {
                added += (added.empty() ? "" : ", ") + address;
                known_.push_back(address);
            }
        }
        if (!added.empty()) {
            added_(added);
        }
    }
}

}  // namespace eti::bus
