// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/convert.hpp"
#include "tests/support/bus_domain.hpp"

namespace eti::devices {

using namespace std::chrono_literals;

[[nodiscard]] inline bus::Options options(const std::string& name) {
    bus::Options out;
    out.session = "test";
    out.domain = test::own_domain();
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
