// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/log_throttle.hpp"

#include <utility>

namespace eti {

namespace {

constexpr std::chrono::seconds interval{1};

}  // namespace

std::optional<std::uint64_t> LogThrottle::allow(std::string_view cause, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    auto known = lines_.find(cause);
    if (known == lines_.end()) {
        const std::string name(lines_.size() + 1 < max_causes ? cause : std::string_view("others"));
        known = lines_.try_emplace(name, Line{now - interval, 0}).first;
    }
    Line& line = known->second;
    if (now - line.last < interval) {
        ++line.suppressed;
        return std::nullopt;
    }
    line.last = now;
    return std::exchange(line.suppressed, 0);
}

std::string suppressed_suffix(std::uint64_t suppressed) {
    return suppressed == 0 ? std::string() : " (" + std::to_string(suppressed) + " more like it)";
}

}  // namespace eti
