// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/parameters.hpp"

namespace eti::review {

/// Grades as instructors give them, 1 (worst) to 5.
inline constexpr int grades = 5;

/// The outcome among the features, which is no parameter.
inline constexpr std::string_view intubated_key = "intubated";

/// What a score looks at: a parameter, how far one is from another, or the outcome.
struct ScoreFeature {
    std::string_view key;         ///< of the parameter, or intubated_key
    bool more_is_better = false;  ///< else less is; a weight never says the opposite
    bool logarithm = false;       ///< of 1 + value: what counts is how many times as much
    /// A parameter that is taken away first; the size of what is left counts, where the trachea was
    /// intubated.
    std::string_view less = {};
};
/// All that is looked at, in the order of a model's weights.
[[nodiscard]] std::span<const ScoreFeature> score_features();
/// NaN where the value does not exist; the outcome is 0 or 1.
[[nodiscard]] double value_of(const ScoreFeature& feature, const Parameters& parameters, bool intubated);

/// A session to learn from.
struct Example {
    Parameters parameters;   ///< of the run
    bool intubated = false;  ///< its outcome
    int grade = 0;           ///< 1 to 5
    std::string patient;     ///< sessions of one are held out together
    std::string person;      ///< the same
};

/// How sure predictions were, and what came of it: of the sessions whose predicted chance of grade 4 or 5
/// lies in a fifth of the range.
struct CalibrationBin {
    std::size_t count = 0;
    double predicted = 0.0, observed = 0.0;  ///< mean chance; share that had it
};

/// How far predicted grades were from those that were given.
struct GradeError {
    std::size_t sessions = 0;
    double mean_error = 0.0;   ///< mean size of the difference to the grade
    double blind_error = 0.0;  ///< of a score that always says the mean grade of such sessions
    double rank = 0.0;         ///< Spearman's correlation of score and grade
};

/// Predictions of sessions of whose patient and person the model had seen nothing.
struct Judgement {
    GradeError all;
    GradeError intubated;      ///< without those that failed, which are told by their outcome
    double right = 0.0;        ///< share told right whether the grade is 4 or 5
    double blind_right = 0.0;  ///< of always saying what is more frequent
    double brier = 0.0;        ///< mean square of the chance's error (Brier 1950)
    std::array<CalibrationBin, 5> calibration;
};

/// A proportional-odds model (McCullagh 1980, J R Stat Soc B 42:109): the log odds of a grade above k are the
/// weighted features less the threshold k.
struct ScoreModel {
    struct Weight {
        double mean = 0.0, deviation = 1.0;  ///< of the feature in training
        double low = 0.0, high = 0.0;  ///< what lies beyond counts as these; what is missing, as the worse
        double weight = 0.0;           ///< log odds for each deviation; its sign is the feature's
    };
    std::string name;     ///< one word
    std::string source;   ///< what the grades are
    bool people = false;  ///< whether a person's rating is among what it learnt from
    std::size_t sessions = 0, patients = 0, persons = 0;
    double penalty = 1.0;
    std::vector<Weight> weights;  ///< one for each of score_features()
    std::array<double, grades - 1> thresholds{};
    Judgement judged;
};

/// What a model makes of a session.
struct Score {
    double grade = 0.0;                   ///< expected, 1 to 5
    std::array<double, grades> chance{};  ///< of each grade
    std::vector<double> contributions;    ///< log odds of each feature; they add up to the whole
    std::vector<bool> measured;  ///< whether the feature exists; else it counts as the worst of training
};

[[nodiscard]] Score score_of(const ScoreModel& model, const Parameters& parameters, bool intubated);

/// Examples from which nothing can be learnt; the text says what was found, what was expected, and what to
/// do.
class ScoreError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Fits weights and thresholds by the greatest likelihood, less `penalty` / 2 times the weights' squares, of
/// which the outcome's counts for a hundredth (NLopt's SLSQP, Kraft 1994). No weight has the wrong sign.
/// Throws ScoreError.
[[nodiscard]] ScoreModel fit(std::span<const Example> examples, double penalty);

/// Predicts each example by a model that was fitted without its patient and without a fifth of the persons,
/// its own among them. Throws ScoreError where there are fewer than two patients or persons.
[[nodiscard]] Judgement judge_score(std::span<const Example> examples, double penalty);

[[nodiscard]] std::string to_yaml(const ScoreModel& model);
/// Throws InputError.
[[nodiscard]] ScoreModel load_score(const std::filesystem::path& file);

/// In words what a model has learnt from; one of scripted operators says that it has seen no human data.
[[nodiscard]] std::string statement_of(const ScoreModel& model);
[[nodiscard]] nlohmann::ordered_json to_json(const Score& score, const ScoreModel& model);
/// For people to read.
[[nodiscard]] std::string to_table(const Score& score, const ScoreModel& model);
[[nodiscard]] std::string to_table(const ScoreModel& model);
/// A page with the calibration plot and the weights, which opens offline.
[[nodiscard]] std::string to_html(const ScoreModel& model);

/// From a session file, for training: graded by the skill of its scripted operator, or 1 where the trachea
/// was not intubated (`label` "skill"), or by the mean of the ratings of an item. Nothing where it has no
/// such grade, or its outcome is unknown.
[[nodiscard]] std::optional<Example> read_example(const std::filesystem::path& file,
                                                  const std::string& label);

}  // namespace eti::review
