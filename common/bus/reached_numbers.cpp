// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/reached_numbers.hpp"

#include <algorithm>

namespace eti::bus {

bool ReachedNumbers::plausible(const WriterId& writer, std::int64_t number, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const auto known = writers_.find(writer);
    if (known == writers_.end()) {
        if (number > first) {
            return false;
        }
        if (writers_.size() >= most_writers) {
            writers_.erase(
                std::ranges::min_element(writers_, {}, [](const auto& one) { return one.second.heard; }));
        }
        writers_.emplace(writer, Reached{number, burst, now});
        return true;
    }
    Reached& reached = known->second;
    // What was not used stays: a writer goes on while the network is cut.
    reached.left +=
        static_cast<double>(per_second) * std::chrono::duration<double>(now - reached.heard).count();
    reached.heard = now;
    const std::int64_t rise = std::max<std::int64_t>(0, number - reached.number);
    if (static_cast<double>(rise) > reached.left) {
        return false;
    }
    reached.left -= static_cast<double>(rise);
    reached.number += rise;
    return true;
}

}  // namespace eti::bus
