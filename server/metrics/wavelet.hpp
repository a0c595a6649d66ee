// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace eti::metrics {

/// Discrete wavelet transform with Daubechies' least asymmetric wavelet of four vanishing moments (sym4;
/// Daubechies, Ten Lectures on Wavelets, 1992, table 6.3). Half-sample symmetric extension at the borders
/// keeps an angle curve with different end values from ringing.
struct WaveletTransform {
    std::vector<double> approximation;         ///< at the coarsest level
    std::vector<std::vector<double>> details;  ///< finest first
    std::vector<std::size_t> lengths;          ///< length of the signal that each level split
};

/// One level: `low` and `high` receive (n + 7) / 2 coefficients each. Needs at least one sample.
void split_level(std::span<const double> signal, std::vector<double>& low, std::vector<double>& high);

/// Inverse of split_level() for a signal of `length` samples.
[[nodiscard]] std::vector<double> join_level(std::span<const double> low, std::span<const double> high,
                                             std::size_t length);

/// Number of levels after which a signal of `length` samples is shorter than the filter: floor(log2(length /
/// 7)).
[[nodiscard]] int useful_levels(std::size_t length);

[[nodiscard]] WaveletTransform wavelet_transform(std::span<const double> signal, int levels);
[[nodiscard]] std::vector<double> inverse_transform(const WaveletTransform& transform);

/// Soft thresholding with the universal threshold s sqrt(2 ln n); s is the median magnitude of the finest
/// details over 0.6745 (Donoho & Johnstone 1994, Biometrika 81:425). Signals of fewer than 14 samples have no
/// useful level and are returned unchanged.
[[nodiscard]] std::vector<double> denoised(std::span<const double> signal);

}  // namespace eti::metrics
