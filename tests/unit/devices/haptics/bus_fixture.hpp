// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/convert.hpp"

namespace eti::devices {

using namespace std::chrono_literals;

/// Each test process has a domain of its own, below those whose ports the kernel hands out.
[[nodiscard]] inline bus::Options options(const std::string& name) {
    bus::Options out;
    out.session = "test";
    out.domain = 1 + static_cast<int>(::getpid() % 100);
    out.name = name;
    return out;
}

template <class Condition>
[[nodiscard]] bool eventually(Condition condition, std::chrono::milliseconds limit = 10s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

}  // namespace eti::devices
