// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/wavelet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eti::metrics {
namespace {

constexpr std::size_t taps = 8;

// Synthesis low-pass of sym4; the other three filters are mirror images of it.
constexpr std::array<double, taps> scaling = {
    0.03222310060404270, -0.01260396726203783, -0.09921954357684722, 0.29785779560527736,
    0.80373875180591614, 0.49761866763201545,  -0.02963552764599851, -0.07576571478927333};

constexpr double low_synthesis(std::size_t i) {
    return scaling[i];
}
constexpr double high_synthesis(std::size_t i) {
    return (i % 2 == 0 ? 1.0 : -1.0) * scaling[taps - 1 - i];
}
constexpr double low_analysis(std::size_t i) {
    return low_synthesis(taps - 1 - i);
}
constexpr double high_analysis(std::size_t i) {
    return high_synthesis(taps - 1 - i);
}

// Sample `i` of the half-sample symmetric extension.
double mirrored(std::span<const double> signal, std::ptrdiff_t i) {
    const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(signal.size());
    std::ptrdiff_t k = i % (2 * n);
    if (k < 0) {
        k += 2 * n;
    }
    return signal[static_cast<std::size_t>(k < n ? k : 2 * n - 1 - k)];
}

double soft(double value, double threshold) {
    const double size = std::abs(value) - threshold;
    return size > 0.0 ? std::copysign(size, value) : 0.0;
}

}  // namespace

void split_level(std::span<const double> signal, std::vector<double>& low, std::vector<double>& high) {
    const std::size_t count = (signal.size() + taps - 1) / 2;
    low.assign(count, 0.0);
    high.assign(count, 0.0);
    for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t j = 0; j < taps; ++j) {
            const double value =
                mirrored(signal, static_cast<std::ptrdiff_t>(2 * k + 1) - static_cast<std::ptrdiff_t>(j));
            low[k] += low_analysis(j) * value;
            high[k] += high_analysis(j) * value;
        }
    }
}

std::vector<double> join_level(std::span<const double> low, std::span<const double> high,
                               std::size_t length) {
    std::vector<double> signal(length, 0.0);
    for (std::size_t i = 0; i < length; ++i) {
        // Coefficient k contributes to sample i through tap i + taps - 2 - 2 k.
        const std::size_t reach = i + taps - 2;
        for (std::size_t k = (reach >= taps - 1 ? (reach - taps + 2) / 2 : 0);
             k < low.size() && 2 * k <= reach; ++k) {
            const std::size_t tap = reach - 2 * k;
            if (tap < taps) {
                signal[i] += low_synthesis(tap) * low[k] + high_synthesis(tap) * high[k];
            }
        }
    }
    return signal;
}

int useful_levels(std::size_t length) {
    int levels = 0;
    for (std::size_t rest = length / (taps - 1); rest >= 2; rest /= 2) {
        ++levels;
    }
    return levels;
}

WaveletTransform wavelet_transform(std::span<const double> signal, int levels) {
    WaveletTransform transform;
    transform.approximation.assign(signal.begin(), signal.end());
    for (int level = 0; level < levels; ++level) {
        transform.lengths.push_back(transform.approximation.size());
        std::vector<double> low;
        std::vector<double> high;
        split_level(transform.approximation, low, high);
        transform.approximation = std::move(low);
        transform.details.push_back(std::move(high));
    }
    return transform;
}

std::vector<double> inverse_transform(const WaveletTransform& transform) {
    std::vector<double> signal = transform.approximation;
    for (std::size_t level = transform.details.size(); level-- > 0;) {
        signal = join_level(signal, transform.details[level], transform.lengths[level]);
    }
    return signal;
}

std::vector<double> denoised(std::span<const double> signal) {
    const int levels = useful_levels(signal.size());
    if (levels == 0) {
        return {signal.begin(), signal.end()};
    }
    WaveletTransform transform = wavelet_transform(signal, levels);
    std::vector<double> sizes;
    for (const double detail : transform.details.front()) {
        sizes.push_back(std::abs(detail));
    }
    const std::size_t middle = sizes.size() / 2;
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(middle), sizes.end());
    double median = sizes[middle];
    if (sizes.size() % 2 == 0) {
        median = 0.5 * (median + *std::max_element(sizes.begin(),
                                                   sizes.begin() + static_cast<std::ptrdiff_t>(middle)));
    }
    const double threshold = median / 0.6745 * std::sqrt(2.0 * std::log(static_cast<double>(signal.size())));
    for (std::vector<double>& level : transform.details) {
        for (double& detail : level) {
            detail = soft(detail, threshold);
        }
    }
    return inverse_transform(transform);
}

}  // namespace eti::metrics
