// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace eti::imaging {

/// Numbers of a text, separated by backslashes (PS3.5, 6.2, DS); empty if one is malformed.
[[nodiscard]] inline std::optional<std::vector<double>> numbers_of(const std::string& text) {
    std::vector<double> out;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('\\', at), text.size());
        const std::size_t first = std::min(text.find_first_not_of(" +", at), end);
        const std::size_t last = text.find_last_not_of(' ', end - 1) + 1;
        double number = 0.0;
        const auto [rest, error] = std::from_chars(text.data() + first, text.data() + end, number);
        if (first >= end || error != std::errc() || rest != text.data() + std::min(last, end) ||
            !std::isfinite(number)) {
            return std::nullopt;
        }
        out.push_back(number);
        at = end + 1;
    }
    return out;
}

}  // namespace eti::imaging
