// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "common/bus/bus.hpp"

namespace eti::bus {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Tests that run at the same time shall not meet: each process has its domain. Up to 100, because
/// the ports of higher domains lie in the range that the kernel hands out to others.
[[nodiscard]] inline int own_domain() {
    return 1 + static_cast<int>(::getpid() % 100);
}

[[nodiscard]] inline Options options(const std::string& name, const std::string& session = "test") {
    Options out;
    out.session = session;
    out.domain = own_domain();
    out.name = name;
    return out;
}

/// Waits until `condition` holds, at most `limit`; discovery takes about 0.1-0.2 s, more on a loaded machine.
template <class Condition>
[[nodiscard]] bool eventually(Condition condition, std::chrono::milliseconds limit = 10s) {
    const auto end = Clock::now() + limit;
    while (!condition()) {
        if (Clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(2ms);
    }
    return true;
}

}  // namespace eti::bus
