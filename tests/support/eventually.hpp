// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <thread>

namespace eti::test {

/// Timeout for events that must occur on any machine, however busy; only a hang takes this long.
constexpr std::chrono::seconds default_timeout{120};

/// Returns whether `condition` becomes true within `limit`; polls once a millisecond.
template <class Condition>
[[nodiscard]] bool eventually(Condition condition, std::chrono::milliseconds limit = default_timeout) {
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
