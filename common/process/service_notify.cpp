// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/service_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace eti {

namespace {

std::string_view variable(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// A positive integer, or nullopt.
std::optional<long> number(std::string_view text) {
    long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && value > 0 ? std::optional(value)
                                                                                 : std::nullopt;
}

}  // namespace

ServiceNotify::ServiceNotify() : address_(variable("NOTIFY_SOCKET")) {
    // Address families other than a path and an abstract name are for containers' hosts; an overlong address
    // is invalid.
    if (address_.size() < 2 || address_.size() >= sizeof(sockaddr_un::sun_path) ||
        (address_[0] != '/' && address_[0] != '@')) {
        return;
    }
    socket_ = Descriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const std::optional<long> microseconds = number(variable("WATCHDOG_USEC"));
    const std::string_view whom = variable("WATCHDOG_PID");
    if (microseconds && (whom.empty() || number(whom) == ::getpid())) {
        interval_ = std::chrono::microseconds(*microseconds) / 4;
    }
}

void ServiceNotify::alive() {
    if (!socket_) {
        return;
    }
    if (!ready_) {
        ready_ = true;
        send("READY=1");
    }
    if (!interval_) {
        return;
    }
    if (const auto now = Time::now(); now >= next_) {
        next_ = now + *interval_;
        send("WATCHDOG=1");
    }
}

void ServiceNotify::send(const std::string& text) {
    if (!socket_) {
        return;
    }
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::memcpy(to.sun_path, address_.data(), address_.size());
    if (to.sun_path[0] == '@') {
        to.sun_path[0] = '\0';
    }
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
    (void)::sendto(socket_.get(), text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                   reinterpret_cast<const sockaddr*>(&to), length);
}

}  // namespace eti
