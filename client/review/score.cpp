// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/score.hpp"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <set>

#include "client/review/summary.hpp"
#include "common/session/record.hpp"

namespace eti::review {

namespace {

constexpr std::size_t cuts = grades - 1;
constexpr int good = 4;  // minimum grade of a good session
constexpr std::size_t folds = 5;

constexpr bool more = true, less = false;  // is better

// Values for which neither more nor less is better, such as the blade's depth, are excluded: they would
// reflect the training's patients and hands.
constexpr ScoreFeature features[] = {
    {intubated_key, more},
    {"gum_force_n.max", less, true},
    {"gum_force_n.mean", less, true},
    {"tongue_force_n.max", less, true},
    {"epiglottis_force_n.max", less, true},
    {"pitch_peaks", less},
    {"yaw_peaks", less},
    {"pitch_rocking_deg", less, true},
    {"yaw_rocking_deg", less, true},
    {"attempts", less},
    {"time_s", less, true},
    {"time_to_first_view_s", less, true},
    {"glottic_opening_percent.mean", more},
    {"view_held_s", more, true},
    {"oesophageal_entries", less},
    {"main_stem_entries", less},
    {"tube_depth_at_lip_cm", less, false, "tube_depth_rule_cm"},
    {"blade_path_length_cm", less, true},
    {"blade_smoothness", more},
};
constexpr std::size_t feature_count = std::size(features);

// Factor of the penalty on the outcome's weight: nearly none. Failures were mostly slow, so a penalty would
// shift weight from the outcome to time, and reward quick failures.
constexpr double outcome_penalty = 0.01;

constexpr double penalty_share(const ScoreFeature& feature) {
    return feature.key == intubated_key ? outcome_penalty : 1.0;
}

double parameter(const AttemptMetrics& metrics, std::string_view key) {
    return metrics.*metric_field(key).value;
}

double logistic(double x) {
    return 1.0 / (1.0 + std::exp(-x));
}

/// The value to use; a missing one, such as a first view that never occurred, counts as the worst in
/// training.
double counted(const ScoreFeature& feature, const ScoreModel::Weight& weight, double value) {
    return !std::isnan(value)       ? std::clamp(value, weight.low, weight.high)
           : feature.more_is_better ? weight.low
                                    : weight.high;
}

/// In standard deviations from the training mean.
double standardised(const ScoreFeature& feature, const ScoreModel::Weight& weight, double value) {
    return (counted(feature, weight, value) - weight.mean) / weight.deviation;
}

/// Probability of each grade at log odds `eta`.
std::array<double, grades> chances(double eta, const std::array<double, cuts>& thresholds) {
    std::array<double, grades> chance{};
    double below = 0.0;
    for (std::size_t k = 0; k < cuts; ++k) {
        const double until = logistic(thresholds[k] - eta);
        chance[k] = until - below;
        below = until;
    }
    chance[cuts] = 1.0 - below;
    return chance;
}

/// The optimisation problem: standardised features (one row each), grades, penalty.
struct Problem {
    std::vector<double> rows;
    std::vector<int> grade;
    double penalty = 1.0;
};

std::array<double, cuts> thresholds_from(const double* x) {
    // The first, then the logarithm of each increment, which keeps them in order.
    std::array<double, cuts> thresholds{};
    thresholds[0] = x[0];
    for (std::size_t k = 1; k < cuts; ++k) {
        thresholds[k] = thresholds[k - 1] + std::exp(x[k]);
    }
    return thresholds;
}

/// Negative log likelihood and its gradient: thresholds first, then weights.
double objective(unsigned count, const double* x, double* gradient, void* data) {
    const Problem& problem = *static_cast<const Problem*>(data);
    const std::array<double, cuts> thresholds = thresholds_from(x);
    const double* const weights = x + cuts;
    double sum = 0.0;
    std::array<double, cuts> by_threshold{};
    if (gradient != nullptr) {
        std::fill_n(gradient, count, 0.0);
    }
    for (std::size_t i = 0; i < problem.grade.size(); ++i) {
        const double* const row = problem.rows.data() + i * feature_count;
        const double eta = std::inner_product(row, row + feature_count, weights, 0.0);
        const auto y = static_cast<std::size_t>(problem.grade[i] - 1);
        const double upper = y < cuts ? logistic(thresholds[y] - eta) : 1.0;
        const double lower = y > 0 ? logistic(thresholds[y - 1] - eta) : 0.0;
        const double chance = std::max(upper - lower, 1e-300);
        sum -= std::log(chance);
        if (gradient == nullptr) {
            continue;
        }
        const double at_upper = upper * (1.0 - upper) / chance, at_lower = lower * (1.0 - lower) / chance;
        if (y < cuts) {
            by_threshold[y] -= at_upper;
        }
        if (y > 0) {
            by_threshold[y - 1] += at_lower;
        }
        for (std::size_t j = 0; j < feature_count; ++j) {
            gradient[cuts + j] += (at_upper - at_lower) * row[j];
        }
    }
    for (std::size_t j = 0; j < feature_count; ++j) {
        const double penalty = problem.penalty * penalty_share(features[j]);
        sum += 0.5 * penalty * weights[j] * weights[j];
        if (gradient != nullptr) {
            gradient[cuts + j] += penalty * weights[j];
        }
    }
    if (gradient != nullptr) {
        // Each threshold moves all above it.
        double above = 0.0;
        for (std::size_t k = cuts; k-- > 0;) {
            above += by_threshold[k];
            gradient[k] = k == 0 ? above : above * std::exp(x[k]);
        }
    }
    return sum;
}

ScoreModel::Weight scale_of(const ScoreFeature& feature, std::span<const Example> examples) {
    std::vector<double> values, there;
    for (const Example& example : examples) {
        values.push_back(value_of(feature, example.metrics, example.intubated));
        if (std::isfinite(values.back())) {
            there.push_back(values.back());
        }
    }
    ScoreModel::Weight weight;
    if (there.empty()) {
        return weight;
    }
    const auto [low, high] = std::ranges::minmax(there);
    weight.low = low;
    weight.high = high;
    for (double& value : values) {
        value = counted(feature, weight, value);
    }
    const auto n = static_cast<double>(values.size());
    weight.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - weight.mean) * (value - weight.mean);
    }
    // A constant feature carries no information.
    weight.deviation = high > low ? std::sqrt(squares / n) : 1.0;
    return weight;
}

/// Mean over intubated sessions, or all; the middle grade if there are none.
double mean_grade(std::span<const Example> examples, bool intubated) {
    double sum = 0.0, count = 0.0;
    for (const Example& example : examples) {
        if (example.intubated || !intubated) {
            sum += example.grade;
            count += 1.0;
        }
    }
    return count > 0.0 ? sum / count : 0.5 * (1 + grades);
}

/// Ranks from 1; ties share their mean rank.
std::vector<double> ranks(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
    std::vector<double> rank(values.size());
    for (std::size_t from = 0; from < order.size();) {
        std::size_t to = from + 1;
        while (to < order.size() && values[order[to]] == values[order[from]]) {
            ++to;
        }
        for (std::size_t i = from; i < to; ++i) {
            rank[order[i]] = 0.5 * static_cast<double>(from + 1 + to);
        }
        from = to;
    }
    return rank;
}

double correlation(const std::vector<double>& x, const std::vector<double>& y) {
    const auto n = static_cast<double>(x.size());
    const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n;
    const double my = std::accumulate(y.begin(), y.end(), 0.0) / n;
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mx) * (x[i] - mx);
        yy += (y[i] - my) * (y[i] - my);
        xy += (x[i] - mx) * (y[i] - my);
    }
    return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0;
}

struct Prediction {
    double score, given, blind;
};

GradeError error_of(const std::vector<Prediction>& predictions) {
    GradeError error;
    error.sessions = predictions.size();
    std::vector<double> scores, given;
    for (const Prediction& one : predictions) {
        scores.push_back(one.score);
        given.push_back(one.given);
        error.mean_error += std::abs(one.score - one.given) / static_cast<double>(predictions.size());
        error.baseline_error += std::abs(one.blind - one.given) / static_cast<double>(predictions.size());
    }
    error.rank = predictions.empty() ? 0.0 : correlation(ranks(scores), ranks(given));
    return error;
}

double chance_of_good(const Score& score) {
    return std::accumulate(score.chance.begin() + (good - 1), score.chance.end(), 0.0);
}

}  // namespace

std::span<const ScoreFeature> score_features() {
    return features;
}

double value_of(const ScoreFeature& feature, const AttemptMetrics& metrics, bool intubated) {
    if (feature.key == intubated_key) {
        return intubated ? 1.0 : 0.0;
    }
    double value = parameter(metrics, feature.key);
    if (!feature.subtracted.empty()) {
        if (!intubated) {
            return std::numeric_limits<double>::quiet_NaN();  // with the tube in the oesophagus no depth is
                                                              // correct
        }
        value = std::abs(value - parameter(metrics, feature.subtracted));
    }
    return feature.logarithm ? std::log1p(std::max(0.0, value)) + (std::isnan(value) ? value : 0.0) : value;
}

Score score_of(const ScoreModel& model, const AttemptMetrics& metrics, bool intubated) {
    Score score;
    double eta = 0.0;
    for (std::size_t j = 0; j < feature_count; ++j) {
        const double value = value_of(features[j], metrics, intubated);
        score.measured.push_back(!std::isnan(value));
        score.contributions.push_back(model.weights[j].weight *
                                      standardised(features[j], model.weights[j], value));
        eta += score.contributions.back();
    }
    score.chance = chances(eta, model.thresholds);
    for (std::size_t k = 0; k < score.chance.size(); ++k) {
        score.grade += static_cast<double>(k + 1) * score.chance[k];
    }
    return score;
}

ScoreModel fit(std::span<const Example> examples, double penalty) {
    std::set<int> seen;
    for (const Example& example : examples) {
        seen.insert(example.grade);
    }
    if (seen.size() < 2) {
        throw ScoreError(
            fmt::format("score: {} sessions of {} different grades; expected at least two grades: give "
                        "sessions of different quality",
                        examples.size(), seen.size()));
    }
    ScoreModel model;
    model.penalty = penalty;
    model.sessions = examples.size();
    Problem problem;
    problem.penalty = penalty;
    for (const ScoreFeature& feature : features) {
        model.weights.push_back(scale_of(feature, examples));
    }
    for (const Example& example : examples) {
        problem.grade.push_back(example.grade);
        for (std::size_t j = 0; j < feature_count; ++j) {
            problem.rows.push_back(standardised(features[j], model.weights[j],
                                                value_of(features[j], example.metrics, example.intubated)));
        }
    }
    constexpr unsigned unknowns = cuts + feature_count;
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
        nlopt_create(NLOPT_LD_SLSQP, unknowns), &nlopt_destroy);
    // An unused grade lets its thresholds converge, so their logarithmic distance is bounded below.
    std::vector<double> low(unknowns, -50.0), high(unknowns, 50.0), x(unknowns, 0.0);
    std::fill_n(low.begin() + 1, cuts - 1, -10.0);
    std::fill_n(high.begin() + 1, cuts - 1, 4.0);
    for (std::size_t j = 0; j < feature_count; ++j) {
        (features[j].more_is_better ? low : high)[cuts + j] = 0.0;
    }
    x[0] = -1.5;
    nlopt_set_lower_bounds(search.get(), low.data());
    nlopt_set_upper_bounds(search.get(), high.data());
    nlopt_set_min_objective(search.get(), objective, &problem);
    nlopt_set_ftol_rel(search.get(), 1e-12);
    nlopt_set_maxeval(search.get(), 3000);
    double least = 0.0;
    const nlopt_result result = nlopt_optimize(search.get(), x.data(), &least);
    // Roundoff may stop the search once no improvement is possible.
    if ((result < 0 && result != NLOPT_ROUNDOFF_LIMITED) || result == NLOPT_MAXEVAL_REACHED ||
        !std::isfinite(least)) {
        throw ScoreError(fmt::format(
            "score: the fit did not converge ({}); raise --penalty, or give more sessions than {}",
            nlopt_result_to_string(result), examples.size()));
    }
    model.thresholds = thresholds_from(x.data());
    for (std::size_t j = 0; j < feature_count; ++j) {
        model.weights[j].weight = x[cuts + j];
    }
    return model;
}

ValidationResult cross_validate(std::span<const Example> examples, double penalty) {
    std::set<std::string> patients, persons;
    for (const Example& example : examples) {
        patients.insert(example.patient);
        persons.insert(example.person);
    }
    if (patients.size() < 2 || persons.size() < 2) {
        throw ScoreError(
            fmt::format("score: {} patients and {} operators; expected at least two of each for "
                        "cross-validation: add sessions of others",
                        patients.size(), persons.size()));
    }
    const auto fold_of = [&](const std::string& person) {
        return static_cast<std::size_t>(std::distance(persons.begin(), persons.find(person))) % folds;
    };
    ValidationResult judgement;
    std::vector<Prediction> all, intubated;
    std::size_t many = 0;
    for (const std::string& patient : patients) {
        for (std::size_t fold = 0; fold < folds; ++fold) {
            std::vector<Example> seen, held_out;
            for (const Example& example : examples) {
                const bool of_patient = example.patient == patient, of_fold = fold_of(example.person) == fold;
                if (of_patient && of_fold) {
                    held_out.push_back(example);
                } else if (!of_patient && !of_fold) {
                    seen.push_back(example);
                }
            }
            if (held_out.empty()) {
                continue;
            }
            const ScoreModel model = fit(seen, penalty);
            const double mean = mean_grade(seen, false), mean_of_intubated = mean_grade(seen, true);
            for (const Example& example : held_out) {
                const Score score = score_of(model, example.metrics, example.intubated);
                const bool is_good = example.grade >= good;
                const double chance = chance_of_good(score);
                const auto given = static_cast<double>(example.grade);
                all.push_back({score.grade, given, mean});
                if (example.intubated) {
                    intubated.push_back({score.grade, given, mean_of_intubated});
                }
                many += is_good ? 1 : 0;
                judgement.accuracy += (chance >= 0.5) == is_good ? 1.0 : 0.0;
                judgement.brier += std::pow(chance - (is_good ? 1.0 : 0.0), 2);
                auto& bin =
                    judgement.calibration[std::min<std::size_t>(static_cast<std::size_t>(chance * 5.0), 4)];
                ++bin.count;
                bin.predicted += chance;
                bin.observed += is_good ? 1.0 : 0.0;
            }
        }
    }
    const auto n = static_cast<double>(all.size());
    judgement.all = error_of(all);
    judgement.intubated = error_of(intubated);
    judgement.accuracy /= n;
    judgement.brier /= n;
    const double share = static_cast<double>(many) / n;
    judgement.baseline_accuracy = std::max(share, 1.0 - share);
    for (CalibrationBin& bin : judgement.calibration) {
        if (bin.count > 0) {
            bin.predicted /= static_cast<double>(bin.count);
            bin.observed /= static_cast<double>(bin.count);
        }
    }
    return judgement;
}

std::optional<Example> read_example(const std::filesystem::path& file, const std::string& label) {
    const Summary summary = summarise(file);
    if (!summary.outcome_known(summary.run)) {
        return std::nullopt;
    }
    Example example;
    example.metrics = summary.run.metrics;
    example.intubated = summary.run.outcome.success;
    example.patient = summary.info.scenario;
    example.person = summary.info.text(session::participant_text);
    if (example.person.empty()) {
        example.person = fmt::format("{} {}", summary.info.operator_name, summary.info.seed);
    }
    double grade = std::numeric_limits<double>::quiet_NaN();
    if (label == "skill") {
        const std::string skill = summary.info.text(session::skill_text);
        double value = 0.0;
        const auto [end, error] = std::from_chars(skill.data(), skill.data() + skill.size(), value);
        if (error == std::errc() && end == skill.data() + skill.size()) {
            grade = example.intubated ? 1.0 + (grades - 1) * value : 1.0;
        }
    } else {
        double sum = 0.0;
        int count = 0;
        for (const session::Rating& rating : summary.ratings) {
            if (rating.item == label) {
                sum += rating.score;
                ++count;
            }
        }
        grade = sum / count;
    }
    if (!(grade >= 1.0 && grade <= grades)) {
        return std::nullopt;
    }
    example.grade = static_cast<int>(std::lround(grade));
    return example;
}

}  // namespace eti::review
