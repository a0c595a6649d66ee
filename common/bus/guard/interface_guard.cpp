// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/interface_guard.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "common/process/files/descriptor.hpp"

namespace eti::bus {

namespace {

/// The address from which the kernel would send to another one; empty without a route.
std::optional<InterfaceGuard::Address> source_towards(const InterfaceGuard::Address& other) {
    const Descriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(9);  // discard; connecting a UDP socket sends nothing
    std::memcpy(&address.sin_addr, other.data(), other.size());
    socklen_t size = sizeof address;
    if (!probe || ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
        ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
        return std::nullopt;
    }
    InterfaceGuard::Address source{};
    std::memcpy(source.data(), &address.sin_addr, source.size());
    return source;
}

}  // namespace

InterfaceGuard::InterfaceGuard(const std::vector<std::string>& own) {
    for (const std::string& text : own) {
        ::inet_pton(AF_INET, text.c_str(), own_.emplace_back().data());
    }
}

bool InterfaceGuard::leads_to(const Address& other, Clock::time_point now) {
    if (other[0] == 127) {
        return true;
    }
    const std::lock_guard lock(mutex_);
    if (const auto known = answers_.find(other); known != answers_.end() && now < known->second.until) {
        return known->second.leads;
    }
    if (answers_.size() >= max_answers) {
        answers_.clear();
    }
    const std::optional<Address> source = source_towards(other);
    const bool leads = source && std::ranges::find(own_, *source) != own_.end();
    answers_.insert_or_assign(other, Answer{leads, now + kept_for});
    return leads;
}

}  // namespace eti::bus
