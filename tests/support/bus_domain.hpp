// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "common/bus/bus.hpp"

namespace eti::test {

/// Returns the DDS domain that this process reserves until it exits, so that concurrent tests do not discover
/// each other. Domains 1 to 100: the ports of higher ones lie in the kernel's ephemeral range.
/// tests/system/support.py reserves domains in the same way. Throws std::runtime_error when all are taken.
[[nodiscard]] inline int own_domain() {
    static const int mine = [] {
        constexpr int domains = 100;
        for (int tried = 0; tried < domains; ++tried) {
            const int domain = 1 + (static_cast<int>(::getpid()) + tried) % domains;
            // An abstract socket name has a single owner and is released when the process exits.
            const std::string name = "eti-test-domain-" + std::to_string(domain);
            sockaddr_un address{};
            address.sun_family = AF_UNIX;
            std::ranges::copy(name, address.sun_path + 1);
            const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
            const int token = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
            if (token < 0) {
                break;
            }
            if (::bind(token, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
                return domain;  // the descriptor stays open
            }
            ::close(token);
        }
        throw std::runtime_error("no DDS domain from 1 to 100 is free for this test");
    }();
    return mine;
}

/// Options for a participant of that name in this process's domain.
[[nodiscard]] inline bus::Options bus_options(const std::string& name, const std::string& session = "test") {
    bus::Options options;
    options.session = session;
    options.domain = own_domain();
    options.name = name;
    return options;
}

}  // namespace eti::test
