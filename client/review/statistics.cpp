// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numeric>

#include "common/math/random.hpp"

namespace eti::review {

namespace {

using Sample = std::vector<double>;

/// The values minus their mean: each value's contribution to a difference of means, and the population to
/// draw from under the null hypothesis. Values that differ only by rounding are made equal.
Sample centred(std::span<const double> values) {
    constexpr double rounding = 1e-10;
    const double mean = mean_of(values);
    Sample out(values.begin(), values.end());
    for (double& value : out) {
        const double size = std::max(std::abs(value), std::abs(mean));
        value = std::abs(value - mean) > rounding * size ? value - mean : 0.0;
    }
    return out;
}

/// Mean and variance of the mean.
struct Drawn {
    double mean = 0.0, variance = 0.0;
};

Drawn draw(const Sample& from, Random& random) {
    const double n = static_cast<double>(from.size());
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        const double value = from[random.bits() % from.size()];
        sum += value;
        squares += value * value;
    }
    const double mean = sum / n;
    return {mean, std::max(0.0, squares / n - mean * mean) / (n - 1.0)};
}

/// Bootstrap draws of the difference, studentised by each draw's own variance, as absolute values.
/// `parts`: centred samples; the first is subtracted from the second, if there are two.
Sample draw_all(const std::vector<Sample>& parts, const Bootstrap& how) {
    Sample draws;
    Random random(how.seed);
    double scale = 0.0;
    for (const Sample& part : parts) {
        for (const double value : part) {
            scale = std::max(scale, std::abs(value));
        }
    }
    for (int i = 0; i < how.resamples; ++i) {
        double difference = 0.0, variance = 0.0;
        for (std::size_t part = 0; part < parts.size(); ++part) {
            const Drawn drawn = draw(parts[part], random);
            difference += part + 1 == parts.size() ? drawn.mean : -drawn.mean;
            variance += drawn.variance;
        }
        // Draws of a single repeated value have only rounding variance.
        const bool flat = std::sqrt(variance) < 1e-12 * scale;
        draws.push_back(!flat                                  ? std::abs(difference) / std::sqrt(variance)
                        : std::abs(difference) < 1e-12 * scale ? 0.0
                                                               : HUGE_VAL);
    }
    return draws;
}

/// The non-centrality at which a t at most this large has probability `p`.
double non_centrality(double freedom, double t, double p) {
    const auto excess = [&](double at) {
        return boost::math::cdf(boost::math::non_central_t(freedom, at), t) - p;
    };
    double low = t - 2.0, high = t + 2.0;
    for (double reach = 2.0; excess(low) < 0.0; reach *= 2.0) {
        low -= reach;
    }
    for (double reach = 2.0; excess(high) > 0.0; reach *= 2.0) {
        high += reach;
    }
    const auto root =
        boost::math::tools::bisect(excess, low, high, boost::math::tools::eps_tolerance<double>(30));
    return 0.5 * (root.first + root.second);
}

/// `scale`: t divided by the standardised difference. Beyond `farthest` the distribution cannot be
/// computed.
void put_effect(Difference& into, double deviation, double scale, double freedom, double level) {
    constexpr double farthest = 35.0;
    if (!(deviation > 0.0) || freedom < 2.0) {  // the bias correction requires at least two
        return;
    }
    const double unbiased =
        boost::math::tgamma_ratio(0.5 * freedom, 0.5 * (freedom - 1.0)) / std::sqrt(0.5 * freedom);
    const double raw = into.value / deviation;
    into.effect = unbiased * raw;
    if (const double t = raw * scale; std::abs(t) < farthest) {
        into.effect_interval = {unbiased / scale * non_centrality(freedom, t, 0.5 * (1.0 + level)),
                                unbiased / scale * non_centrality(freedom, t, 0.5 * (1.0 - level))};
    }
}

/// All fields except the effect, for samples whose means differ by `value`.
Difference bootstrapped(const std::vector<Sample>& parts, double value, const Bootstrap& how) {
    Difference out;
    out.value = value;
    double variance = 0.0, spread = 0.0;
    for (const Sample& part : parts) {
        const double n = static_cast<double>(part.size());
        const double squares = std::inner_product(part.begin(), part.end(), part.begin(), 0.0);
        variance += squares / n / (n - 1.0);
        spread = std::max(spread, squares);
    }
    if (!(spread > 0.0)) {
        out.interval = {value, value};
        return out;
    }
    Sample draws = draw_all(parts, how);
    const double error = std::sqrt(variance);
    const double t = std::abs(value) / error;
    const auto as_far = std::ranges::count_if(draws, [t](double drawn) { return drawn >= t; });
    out.p = static_cast<double>(as_far + 1) / static_cast<double>(how.resamples + 1);
    // The test's dual: p <= 1 - level where at most rank - 1 draws are as far as t, that is, where t exceeds
    // the draw of this rank from above.
    const auto rank = static_cast<std::ptrdiff_t>((1.0 - how.level) * (how.resamples + 1) * (1.0 + 1e-12));
    if (rank < 1) {
        return out;
    }
    std::ranges::nth_element(draws, draws.begin() + (rank - 1), std::ranges::greater{});
    const double half = draws[static_cast<std::size_t>(rank - 1)] * error;
    if (std::isfinite(half)) {
        out.interval = {value - half, value + half};
    }
    return out;
}

}  // namespace

double mean_of(std::span<const double> values) {
    return values.empty()
               ? no_value
               : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
    if (values.size() < 2) {
        return no_value;
    }
    const Sample about = centred(values);
    return std::sqrt(std::inner_product(about.begin(), about.end(), about.begin(), 0.0) /
                     static_cast<double>(values.size() - 1));
}

Difference difference_between(std::span<const double> a, std::span<const double> b, const Bootstrap& how) {
    Difference out;
    out.value = mean_of(b) - mean_of(a);
    if (a.size() < 2 || b.size() < 2) {
        return out;
    }
    out = bootstrapped({centred(a), centred(b)}, out.value, how);
    const double n = static_cast<double>(a.size()), m = static_cast<double>(b.size());
    const double pooled = std::sqrt(
        ((n - 1.0) * std::pow(standard_deviation(a), 2) + (m - 1.0) * std::pow(standard_deviation(b), 2)) /
        (n + m - 2.0));
    put_effect(out, pooled, std::sqrt(n * m / (n + m)), n + m - 2.0, how.level);
    return out;
}

Difference difference_within(std::span<const double> differences, const Bootstrap& how) {
    Difference out;
    out.value = mean_of(differences);
    if (differences.size() < 2) {
        return out;
    }
    out = bootstrapped({centred(differences)}, out.value, how);
    const double n = static_cast<double>(differences.size());
    put_effect(out, standard_deviation(differences), std::sqrt(n), n - 1.0, how.level);
    return out;
}

std::vector<double> holm_adjusted(std::span<const double> p) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!std::isnan(p[i])) {
            order.push_back(i);
        }
    }
    std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
    std::vector<double> adjusted(p.begin(), p.end());
    double greatest = 0.0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        greatest = std::max(greatest, p[order[rank]] * static_cast<double>(order.size() - rank));
        adjusted[order[rank]] = std::min(1.0, greatest);
    }
    return adjusted;
}

Agreement agreement(const std::vector<std::vector<double>>& scores, double level) {
    Agreement out;
    if (scores.size() < 2 || scores.front().size() < 2) {
        return out;
    }
    const double n = static_cast<double>(scores.size()), k = static_cast<double>(scores.front().size());
    Sample all, raters(scores.front().size(), 0.0);
    double rows = 0.0;
    for (const Sample& row : scores) {
        all.insert(all.end(), row.begin(), row.end());
        for (std::size_t j = 0; j < row.size(); ++j) {
            raters[j] += row[j] / n;
        }
    }
    const double middle = mean_of(all);
    const auto square = [](double x) { return x * x; };
    for (const Sample& row : scores) {
        rows += k * square(mean_of(row) - middle);
    }
    double columns = 0.0, total = 0.0;
    for (const double mean : raters) {
        columns += n * square(mean - middle);
    }
    for (const double score : all) {
        total += square(score - middle);
    }
    if (!(total > 0.0)) {
        return out;
    }
    // Mean squares of rows, raters and residual; the last is kept from becoming negative by rounding.
    const double msr = rows / (n - 1.0), msj = columns / (k - 1.0);
    const double mse = std::max(0.0, total - rows - columns) / ((n - 1.0) * (k - 1.0));
    out.single = (msr - mse) / (msr + (k - 1.0) * mse + k * (msj - mse) / n);
    out.mean = (msr - mse) / (msr + (msj - mse) / n);
    if (!(mse > 1e-12 * total)) {
        return out;  // raters differ only by constants: F is infinite
    }
    const double r = out.single, f = msj / mse;
    const double v = (k - 1.0) * (n - 1.0) * square(k * r * f + n * (1.0 + (k - 1.0) * r) - k * r) /
                     ((n - 1.0) * square(k * r * f) + square(n * (1.0 + (k - 1.0) * r) - k * r));
    const double tail = 0.5 * (1.0 + level);
    const double above = boost::math::quantile(boost::math::fisher_f(n - 1.0, v), tail);
    const double below = boost::math::quantile(boost::math::fisher_f(v, n - 1.0), tail);
    const double rest = k * msj + (k * n - k - n) * mse;
    out.single_interval = {n * (msr - above * mse) / (above * rest + n * msr),
                           n * (below * msr - mse) / (rest + n * below * msr)};
    const auto of_mean = [k](double one) { return k * one / (1.0 + (k - 1.0) * one); };
    out.mean_interval = {of_mean(out.single_interval.low), of_mean(out.single_interval.high)};
    return out;
}

}  // namespace eti::review
