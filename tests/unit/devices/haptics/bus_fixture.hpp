// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/codec/convert.hpp"
#include "tests/support/bus_domain.hpp"
#include "tests/support/eventually.hpp"

namespace eti::devices {

using namespace std::chrono_literals;

[[nodiscard]] inline bus::Options options(const std::string& name) {
    return test::bus_options(name);
}

using test::eventually;

}  // namespace eti::devices
