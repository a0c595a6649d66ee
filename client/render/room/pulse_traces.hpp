// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace eti::render {

/// Electrocardiogram, lead II, `after` [s] after a beat's P wave begins, with the next beat `period` [s]
/// later; the R wave's height is 1.
[[nodiscard]] float electrocardiogram(float after, float period);

/// Plethysmogram of a pulse oximeter, of height 1, the same.
[[nodiscard]] float plethysmogram(float after, float period);

/// The curves on a patient monitor, which sweep over its screen. Beats follow each other at the rate that
/// holds when they occur; after a gap, as if the present rate had held before.
class PulseTraces {
  public:
    static constexpr int columns = 192;
    static constexpr float sweep_s = 4.0f;

    struct Column {
        float ecg_low, ecg_high, pleth_low, pleth_high;  ///< range of a curve within the column
    };

    /// `rate` [1/min]; nullopt without a signal: flat curves.
    void update(double time_s, std::optional<double> rate);
    [[nodiscard]] std::span<const Column> values() const { return values_; }
    /// Column at which the sweep now stands.
    [[nodiscard]] int head() const { return head_; }
    /// Times [s] of the beats on the screen, oldest first.
    [[nodiscard]] std::span<const double> beats() const { return beats_; }

  private:
    std::vector<double> beats_;
    std::array<Column, columns> values_{};
    double time_s_ = -1.0;
    double rate_ = 0.0;
    int head_ = 0;
};

}  // namespace eti::render
