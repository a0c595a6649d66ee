// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace eti::metrics {

/// Counts the maxima of a curve whose prominence (height above the higher of the two lowest points
/// that separate it from higher ground or from the curve's ends) is at least `prominence`, sample by
/// sample. A maximum counts once the curve has fallen by the prominence behind it after having risen
/// by it: between two such maxima the curve dips that far below both, and any maximum of that
/// prominence has such a rise and fall, so this is the count of find_peaks(prominence=...).
class PeakCounter {
  public:
    explicit PeakCounter(double prominence) : prominence_(prominence) {}

    void add(double value);
    [[nodiscard]] int count() const { return count_; }

  private:
    double prominence_;
    double extreme_ = 0.0;  // lowest since the last peak, or highest since the rise
    bool rising_ = false;
    bool started_ = false;
    int count_ = 0;
};

/// Largest absolute difference between a curve and its wavelet-denoised self.
[[nodiscard]] double rocking(std::span<const double> curve);

/// Smoothness of a speed profile sampled at `rate` [Hz]: minus the logarithm of its dimensionless jerk, the
/// integral of the squared second derivative of speed times duration^3 over the greatest speed squared
/// (Hogan & Sternad 2009, J Mot Behav 41:529; logarithm as in Balasubramanian et al. 2015, J NeuroEng
/// Rehabil 12:112). A minimum-jerk movement has -ln 204.8. NaN for fewer than 4 samples or a speed of zero
/// throughout; infinite where speed changes evenly.
[[nodiscard]] double log_dimensionless_jerk(std::span<const double> speed, double rate);

/// A time series on a uniform grid, each sample the mean over its bin. When `capacity` samples are
/// exceeded, neighbours merge and the bins double, so memory stays bounded however long a run is.
class BinnedSeries {
  public:
    BinnedSeries(double rate, std::size_t capacity) : width_(1.0 / rate), capacity_(capacity) {}

    /// Adds `value` at `time` [s] since the series began; times must not decrease. Returns how many
    /// bins this completed. Bins that no sample fell into take values on the line between neighbours.
    std::size_t add(double time, double value);

    [[nodiscard]] std::span<const double> values() const { return values_; }
    [[nodiscard]] double width() const { return width_; }

  private:
    void merge();

    double width_;  // [s]
    std::size_t capacity_;
    std::vector<double> values_;  // finished bins
    std::size_t bin_ = 0;         // being filled
    double sum_ = 0.0;
    int samples_ = 0;
};

}  // namespace eti::metrics
