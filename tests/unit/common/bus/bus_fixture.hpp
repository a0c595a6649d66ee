// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "common/bus/bus.hpp"
#include "tests/support/bus_domain.hpp"
#include "tests/support/eventually.hpp"

namespace eti::bus {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

[[nodiscard]] inline Options options(const std::string& name, const std::string& session = "test") {
    return test::bus_options(name, session);
}

/// Waits until `condition` holds, at most `limit`; discovery takes about 0.1-0.2 s, more on a loaded machine.
using test::eventually;

}  // namespace eti::bus
