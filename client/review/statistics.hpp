// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace eti::review {

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A confidence interval; NaN if the data do not determine one.
struct Interval {
    double low = no_value, high = no_value;
};

/// Bootstrap settings. The same seed gives the same numbers on every machine.
struct Bootstrap {
    int resamples = 10000;  ///< cost is proportional; 1,000 leave a p of 0.05 uncertain by 0.007
    std::uint64_t seed = 1;
    double level = 0.95;  ///< confidence level of all intervals
};

/// Difference of two means with its statistics.
struct Difference {
    double value = no_value;
    /// Symmetric studentised bootstrap interval (Hall 1988, J R Stat Soc B 50:35), the dual of the test: it
    /// excludes zero exactly if p <= 1 - level. NaN if the sample is too small to bound it.
    Interval interval;
    /// Two-sided p for no difference: bootstrap of the studentised difference, with samples shifted to a
    /// common mean (Efron & Tibshirani 1993, An Introduction to the Bootstrap, algorithm 16.2). NaN if
    /// nothing varies.
    double p = no_value;
    /// Hedges' g: in standard deviations, corrected for small samples (Hedges 1981, J Educ Stat 6:107); for
    /// pairs, in standard deviations of their difference. Interval by the non-central t distribution, which
    /// assumes normal values.
    double effect = no_value;
    Interval effect_interval;
};

/// NaN for an empty sample.
[[nodiscard]] double mean_of(std::span<const double> values);
/// Sample standard deviation (n - 1); NaN for fewer than two values.
[[nodiscard]] double standard_deviation(std::span<const double> values);

/// Mean of `b` minus mean of `a`, two independent samples of finite values. If either has fewer than two,
/// only the value is set.
[[nodiscard]] Difference difference_between(std::span<const double> a, std::span<const double> b,
                                            const Bootstrap& how);
/// Mean of the differences within pairs.
[[nodiscard]] Difference difference_within(std::span<const double> differences, const Bootstrap& how);

/// Holm-adjusted p values (Holm 1979, Scand J Stat 6:65), one test per value; NaN are not counted and stay
/// NaN.
[[nodiscard]] std::vector<double> holm_adjusted(std::span<const double> p);

/// Intraclass correlations of ratings by the same raters, two-way random effects, absolute agreement
/// (Shrout & Fleiss 1979, Psychol Bull 86:420; intervals: McGraw & Wong 1996, Psychol Methods 1:30).
struct Agreement {
    double single = no_value;  ///< ICC(2,1): of a single rater's score
    double mean = no_value;    ///< ICC(2,k): of the mean of all raters' scores
    Interval single_interval, mean_interval;
};

/// `scores`: [subjects n | raters k], all rated by the same raters. All NaN for n or k under two, or if all
/// scores are equal.
[[nodiscard]] Agreement agreement(const std::vector<std::vector<double>>& scores, double level);

}  // namespace eti::review
