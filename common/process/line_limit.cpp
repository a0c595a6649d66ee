// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/line_limit.hpp"

#include <utility>

namespace eti {

namespace {

constexpr std::chrono::seconds interval{1};

}  // namespace

std::optional<std::uint64_t> LineLimit::allow(std::string_view cause, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    auto known = lines_.find(cause);
    if (known == lines_.end()) {
        const std::string name(lines_.size() + 1 < most_causes ? cause : std::string_view("others"));
        known = lines_.try_emplace(name, Line{now - interval, 0}).first;
    }
    Line& line = known->second;
    if (now - line.last < interval) {
        ++line.kept_back;
        return std::nullopt;
    }
    line.last = now;
    return std::exchange(line.kept_back, 0);
}

std::string and_more(std::uint64_t kept_back) {
    return kept_back == 0 ? std::string() : " (" + std::to_string(kept_back) + " more like it)";
}

}  // namespace eti
