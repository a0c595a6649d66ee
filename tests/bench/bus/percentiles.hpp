// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

namespace eti::bench {

/// Percentiles, maximum and count of samples; without samples only the count.
[[nodiscard]] inline nlohmann::json percentiles(std::vector<double> samples) {
    nlohmann::json out{{"count", samples.size()}};
    if (samples.empty()) {
        return out;
    }
    std::ranges::sort(samples);
    const auto at = [&](double share) {
        return samples[static_cast<std::size_t>(share * static_cast<double>(samples.size() - 1))];
    };
    out["p50"] = at(0.5);
    out["p99"] = at(0.99);
    out["p99_9"] = at(0.999);
    out["max"] = samples.back();
    return out;
}

}  // namespace eti::bench
