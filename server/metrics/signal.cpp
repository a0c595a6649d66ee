// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/signal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/metrics/wavelet.hpp"

namespace eti::metrics {
void PeakCounter::add(double value) {
    if (!started_) {
        started_ = true;
        extreme_ = value;
        return;
    }
    if (rising_) {
        extreme_ = std::max(extreme_, value);
        if (value <= extreme_ - prominence_) {
            ++count_;
            rising_ = false;
            extreme_ = value;
        }
    } else {
        extreme_ = std::min(extreme_, value);
        if (value >= extreme_ + prominence_) {
            rising_ = true;
            extreme_ = value;
        }
    }
}

double rocking(std::span<const double> curve) {
    const std::vector<double> smooth = denoised(curve);
    double largest = 0.0;
    for (std::size_t i = 0; i < curve.size(); ++i) {
        largest = std::max(largest, std::abs(curve[i] - smooth[i]));
    }
    return largest;
}

double log_dimensionless_jerk(std::span<const double> speed, double rate) {
    const double peak = speed.empty() ? 0.0 : *std::max_element(speed.begin(), speed.end());
    if (speed.size() < 4 || !(peak > 0.0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    double squares = 0.0;
    for (std::size_t i = 1; i + 1 < speed.size(); ++i) {
        const double jerk = (speed[i - 1] - 2.0 * speed[i] + speed[i + 1]) * rate * rate;
        squares += jerk * jerk / rate;
    }
    const double duration = static_cast<double>(speed.size()) / rate;
    return -std::log(std::pow(duration, 3) / (peak * peak) * squares);
}

void BinnedSeries::merge() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 1 < values_.size(); i += 2) {
        values_[kept++] = 0.5 * (values_[i] + values_[i + 1]);
    }
    const bool odd = values_.size() % 2 != 0;
    if (odd) {  // the last completed bin is the first half of the one being filled
        sum_ += values_.back();
        ++samples_;
    }
    values_.resize(kept);
    bin_ = kept;
    width_ *= 2.0;
}

std::size_t BinnedSeries::add(double time, double value) {
    std::size_t finished = 0;
    std::size_t bin = static_cast<std::size_t>(std::max(0.0, time / width_ + 1e-6));
    if (samples_ > 0 && bin > bin_) {
        const double mean = sum_ / samples_;
        const std::size_t from = bin_;
        values_.push_back(mean);
        for (++bin_; bin_ < bin; ++bin_) {
            const double share = static_cast<double>(bin_ - from) / static_cast<double>(bin - from);
            values_.push_back(mean + share * (value - mean));
        }
        finished = bin - from;
        sum_ = 0.0;
        samples_ = 0;
        while (values_.size() >= capacity_) {
            merge();
        }
    }
    sum_ += value;
    ++samples_;
    return finished;
}

}  // namespace eti::metrics
