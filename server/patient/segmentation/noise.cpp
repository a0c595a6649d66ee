// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace eti::segmentation {

float estimate_noise(const imaging::Volume& volume) {
    constexpr float lowest = -200.0f, highest = 280.0f;  // [HU], soft tissue with four deviations of 60 HU
    constexpr std::size_t most = 2'000'000;  // differences: the median's error is then below a thousandth
    const imaging::Geometry& g = volume.geometry;
    const std::size_t stride = std::max<std::size_t>(1, volume.value.size() / most);
    std::vector<float> differences;
    for (std::size_t i = 0; i < volume.value.size(); i += stride) {
        const auto [x, y, z] = g.coordinates(i);
        const bool along_rows = i / stride % 2 == 0;
        const int at = along_rows ? x : y;
        const int size = g.size[along_rows ? 0 : 1];
        if (at < 1 || at + 1 >= size) {
            continue;
        }
        const std::size_t step = along_rows ? 1 : static_cast<std::size_t>(g.size[0]);
        const float before = volume.value[i - step], here = volume.value[i], after = volume.value[i + step];
        if (std::min({before, here, after}) > lowest && std::max({before, here, after}) < highest) {
            differences.push_back(std::fabs(before - 2.0f * here + after));
        }
    }
    if (differences.empty()) {
        return 0.0f;
    }
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::ranges::nth_element(differences, middle);
    // The median of |x| of a normal distribution is 0.6745 deviations; a second difference of independent
    // values has six times their variance.
    return *middle / (0.6745f * std::sqrt(6.0f));
}

float noise_after_smoothing(float sigma) {
    // The sum of the squared weights of a normalised Gaussian, in three dimensions.
    return std::pow(2.0f * std::sqrt(std::numbers::pi_v<float>) * sigma, -1.5f);
}

}  // namespace eti::segmentation
