// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/signal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "server/metrics/wavelet.hpp"

namespace eti::metrics {
namespace {

// In-place radix-2 transform (Cooley & Tukey 1965); the size is a power of two.
void fourier_transform(std::vector<std::complex<double>>& data) {
    const std::size_t n = data.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1;
        for (; (j & bit) != 0; bit >>= 1) {
            j ^= bit;
        }
        j ^= bit;
        if (i < j) {
            std::swap(data[i], data[j]);
        }
    }
    for (std::size_t length = 2; length <= n; length *= 2) {
        const double angle = -2.0 * std::numbers::pi / static_cast<double>(length);
        for (std::size_t k = 0; k < length / 2; ++k) {
            const std::complex<double> turn = std::polar(1.0, angle * static_cast<double>(k));
            for (std::size_t start = 0; start < n; start += length) {
                const std::complex<double> odd = turn * data[start + k + length / 2];
                data[start + k + length / 2] = data[start + k] - odd;
                data[start + k] += odd;
            }
        }
    }
}

}  // namespace

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

double spectral_arc_length(std::span<const double> speed, double rate) {
    constexpr double highest_frequency = 10.0;  // [Hz]
    constexpr double least_magnitude = 0.05;    // of the spectrum's largest
    if (speed.size() < 4) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::size_t size = 16;  // zero padding by four octaves, as in the authors' program
    for (std::size_t reached = 1; reached < speed.size(); reached *= 2) {
        size *= 2;
    }
    std::vector<std::complex<double>> spectrum(size);
    std::copy(speed.begin(), speed.end(), spectrum.begin());
    fourier_transform(spectrum);

    const std::size_t bins = std::min(
        size / 2, static_cast<std::size_t>(highest_frequency * static_cast<double>(size) / rate) + 1);
    std::vector<double> magnitude;
    double largest = 0.0;
    for (std::size_t i = 0; i < bins; ++i) {
        magnitude.push_back(std::abs(spectrum[i]));
        largest = std::max(largest, magnitude.back());
    }
    if (largest <= 0.0) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::size_t first = bins;
    std::size_t last = 0;
    for (std::size_t i = 0; i < bins; ++i) {
        magnitude[i] /= largest;
        if (magnitude[i] >= least_magnitude) {
            first = std::min(first, i);
            last = i;
        }
    }
    double length = 0.0;
    for (std::size_t i = first + 1; i <= last; ++i) {
        length += std::hypot(1.0 / static_cast<double>(last - first), magnitude[i] - magnitude[i - 1]);
    }
    return -length;
}

void BinnedSeries::merge() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 1 < values_.size(); i += 2) {
        values_[kept++] = 0.5 * (values_[i] + values_[i + 1]);
    }
    const bool odd = values_.size() % 2 != 0;
    if (odd) {  // the last finished bin is the first half of the one being filled
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
