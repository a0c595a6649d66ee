// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace eti::review {

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A confidence interval; NaN where the numbers do not give one.
struct Interval {
    double low = no_value, high = no_value;
};

/// How the bootstrap draws. The same seed gives the same numbers on every machine.
struct Bootstrap {
    int resamples = 10000;  ///< cost grows with them; 1,000 leave a p of 0.05 uncertain by 0.007
    std::uint64_t seed = 1;
    double level = 0.95;  ///< of all intervals
};

/// Difference of two means, with what is known of it.
struct Difference {
    double value = no_value;
    /// Bias-corrected and accelerated bootstrap interval (Efron 1987, J Am Stat Assoc 82:171).
    Interval interval;
    /// Two-sided, of no difference: bootstrap of the studentised difference of samples moved to a common mean
    /// (Efron & Tibshirani 1993, An Introduction to the Bootstrap, algorithm 16.2). NaN where nothing varies.
    double p = no_value;
    /// Hedges' g: in standard deviations, without the bias of small samples (Hedges 1981, J Educ Stat 6:107);
    /// of pairs in those of their difference. Interval by the non-central t distribution, which takes
    /// the values for normal ones.
    double effect = no_value;
    Interval effect_interval;
};

/// NaN of nothing.
[[nodiscard]] double mean_of(std::span<const double> values);
/// Of a sample (n - 1); NaN of fewer than two.
[[nodiscard]] double deviation_of(std::span<const double> values);

/// Mean of `b` minus mean of `a`, two independent samples of finite values. Fewer than two in one of them
/// leave the value alone.
[[nodiscard]] Difference difference_between(std::span<const double> a, std::span<const double> b,
                                            const Bootstrap& how);
/// Mean of differences within pairs.
[[nodiscard]] Difference difference_within(std::span<const double> differences, const Bootstrap& how);

/// Adjusted for as many tests as there are values (Holm 1979, Scand J Stat 6:65); NaN are none and stay.
[[nodiscard]] std::vector<double> holm(std::span<const double> p);

/// Intraclass correlations of ratings by the same raters, two-way random effects, absolute agreement (Shrout
/// & Fleiss 1979, Psychol Bull 86:420; intervals: McGraw & Wong 1996, Psychol Methods 1:30).
struct Agreement {
    double single = no_value;  ///< ICC(2,1): of one rater's score
    double mean = no_value;    ///< ICC(2,k): of the mean of all raters' scores
    Interval single_interval, mean_interval;
};

/// `scores`: a row for each of n rated, with the scores of the same k raters. All NaN for n or k under two,
/// or where no score differs from another.
[[nodiscard]] Agreement agreement(const std::vector<std::vector<double>>& scores, double level);

}  // namespace eti::review
