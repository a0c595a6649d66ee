// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace eti::metrics {

/// Counts, sample by sample, the maxima of a curve whose prominence is at least `prominence`. Prominence is
/// the height above the higher of the two lowest points that separate the maximum from higher ground or from
/// the curve's ends.
///
/// A maximum counts once the curve has risen by the prominence before it and fallen by the prominence after
/// it. Between two such maxima the curve dips that far below both, and any maximum of that prominence has
/// such a rise and fall. The count therefore equals that of find_peaks(prominence=...).
class PeakCounter {
  public:
    explicit PeakCounter(double prominence) : prominence_(prominence) {}

    void add(double value);
    [[nodiscard]] int count() const { return count_; }

  private:
    double prominence_;
    double extreme_ = 0.0;  // minimum since the last peak, or maximum since the rise
    bool rising_ = false;
    bool started_ = false;
    int count_ = 0;
};

/// Largest absolute difference between a curve and its wavelet-denoised version.
[[nodiscard]] double rocking(std::span<const double> curve);

/// Smoothness of a speed profile sampled at `rate` [Hz]: minus the logarithm of its dimensionless jerk,
/// -ln(integral of (d^2 speed/dt^2)^2 dt * duration^3 / max speed^2) (Hogan & Sternad 2009, J Mot Behav
/// 41:529; logarithm as in Balasubramanian et al. 2015, J NeuroEng Rehabil 12:112). A minimum-jerk movement
/// has -ln 204.8. NaN for fewer than 4 samples or zero speed throughout; infinite where speed changes
/// linearly.
[[nodiscard]] double log_dimensionless_jerk(std::span<const double> speed, double rate);

/// A time series on a uniform grid; each sample is the mean over its bin. When `capacity` samples are
/// exceeded, adjacent bins merge and the bin width doubles, so that memory stays bounded.
class BinnedSeries {
  public:
    BinnedSeries(double rate, std::size_t capacity) : width_(1.0 / rate), capacity_(capacity) {}

    /// Adds `value` at `time` [s] since the series began; times must not decrease. Returns the number of bins
    /// completed. Empty bins are filled by linear interpolation.
    std::size_t add(double time, double value);

    [[nodiscard]] std::span<const double> values() const { return values_; }
    [[nodiscard]] double width() const { return width_; }

  private:
    void merge();

    double width_;  // [s]
    std::size_t capacity_;
    std::vector<double> values_;  // completed bins
    std::size_t bin_ = 0;         // index of the bin being filled
    double sum_ = 0.0;
    int samples_ = 0;
};

}  // namespace eti::metrics
