// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <thread>

namespace eti::test {

/// How long to wait for what comes on any machine, however busy: only what hangs takes so long.
constexpr std::chrono::seconds patience{120};

/// Whether `condition` comes to hold within `limit`; looks once a millisecond.
template <class Condition>
[[nodiscard]] bool eventually(Condition condition, std::chrono::milliseconds limit = patience) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

}  // namespace eti::test
