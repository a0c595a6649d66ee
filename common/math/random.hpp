// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace eti {

/// SplitMix64 (Steele, Lea & Flood 2014). Not a <random> distribution: those differ between standard
/// libraries, and a session must reproduce bit for bit.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    [[nodiscard]] std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }

    /// Uniform in [0, 1).
    [[nodiscard]] float uniform() { return static_cast<float>(bits() >> 40) * 0x1.0p-24f; }

    /// Standard normal (Box-Muller).
    [[nodiscard]] float normal() {
        const float radius = std::sqrt(-2.0f * std::log(1.0f - uniform()));
        return radius * std::cos(2.0f * std::numbers::pi_v<float> * uniform());
    }

  private:
    std::uint64_t state_;
};

}  // namespace eti
