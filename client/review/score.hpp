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

#include "common/model/attempt_metrics.hpp"

namespace eti::review {

/// Grades as instructors give them, 1 (worst) to 5.
inline constexpr int grades = 5;

/// Key of the outcome among the features; not a metric.
inline constexpr std::string_view intubated_key = "intubated";

/// A feature of the score: a metric, the distance between two metrics, or the outcome.
struct ScoreFeature {
    std::string_view key;         ///< of the metric, or intubated_key
    bool more_is_better = false;  ///< else less is better; constrains the weight's sign
    bool logarithm = false;       ///< uses log(1 + value): ratios matter
    /// A metric to subtract first; the feature is the magnitude of the difference, if the trachea was
    /// intubated.
    std::string_view subtracted = {};
};
/// All features, in the order of a model's weights.
[[nodiscard]] std::span<const ScoreFeature> score_features();
/// NaN if the value does not exist; the outcome is 0 or 1.
[[nodiscard]] double value_of(const ScoreFeature& feature, const AttemptMetrics& metrics, bool intubated);

/// A training session.
struct Example {
    AttemptMetrics metrics;  ///< of the run
    bool intubated = false;  ///< its outcome
    int grade = 0;           ///< 1 to 5
    std::string patient;     ///< sessions of one patient are held out together
    std::string person;      ///< likewise
};

/// Calibration of the sessions whose predicted probability of grade 4 or 5 lies in one fifth of the range.
struct CalibrationBin {
    std::size_t count = 0;
    double predicted = 0.0, observed = 0.0;  ///< mean predicted probability; observed fraction
};

/// Error of predicted grades.
struct GradeError {
    std::size_t sessions = 0;
    double mean_error = 0.0;      ///< mean absolute error of the grade
    double baseline_error = 0.0;  ///< of a score that always predicts the mean grade of such sessions
    double rank = 0.0;            ///< Spearman correlation of score and grade
};

/// Cross-validated predictions, for patients and persons not in the training set.
struct ValidationResult {
    GradeError all;
    GradeError intubated;            ///< without failed sessions, which the outcome alone identifies
    double accuracy = 0.0;           ///< fraction correctly classified as grade 4 or 5
    double baseline_accuracy = 0.0;  ///< of always predicting the more frequent class
    double brier = 0.0;              ///< Brier score: mean squared error of the probability (Brier 1950)
    std::array<CalibrationBin, 5> calibration;
};

/// A proportional-odds model (McCullagh 1980, J R Stat Soc B 42:109): the log odds of a grade above k are
/// the weighted sum of the features minus the threshold k.
struct ScoreModel {
    struct Weight {
        double mean = 0.0, deviation = 1.0;  ///< of the feature in training
        double low = 0.0, high = 0.0;  ///< values are clamped to this range; a missing value counts as the
                                       ///< worse end
        double weight = 0.0;           ///< log odds per standard deviation; its sign is fixed by the
                                       ///< feature
    };
    std::string name;          ///< one word
    std::string source;        ///< origin of the grades
    bool human_rated = false;  ///< whether the training data include a person's rating
    std::size_t sessions = 0, patients = 0, persons = 0;
    double penalty = 1.0;
    std::vector<Weight> weights;  ///< one per score_features()
    std::array<double, grades - 1> thresholds{};
    ValidationResult validation;
};

/// A model's prediction for a session.
struct Score {
    double grade = 0.0;                   ///< expected, 1 to 5
    std::array<double, grades> chance{};  ///< probability of each grade
    std::vector<double> contributions;    ///< log odds of each feature; they add up to the total
    std::vector<bool> measured;           ///< whether the feature exists; otherwise it counts as the worst in
                                          ///< training
};

[[nodiscard]] Score score_of(const ScoreModel& model, const AttemptMetrics& metrics, bool intubated);

/// Examples that cannot be used for training; the message states what was found, what was expected, and the
/// remedy.
class ScoreError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Fits weights and thresholds by penalised maximum likelihood: `penalty` / 2 times the squared weights,
/// with the outcome's weight counting a hundredth (NLopt's SLSQP, Kraft 1994). The weights' signs are
/// constrained. Throws ScoreError.
[[nodiscard]] ScoreModel fit(std::span<const Example> examples, double penalty);

/// Predicts each example with a model fitted without its patient and without a fifth of the persons,
/// including its own. Throws ScoreError for fewer than two patients or persons.
[[nodiscard]] ValidationResult cross_validate(std::span<const Example> examples, double penalty);

[[nodiscard]] std::string to_yaml(const ScoreModel& model);
/// Throws InputError.
[[nodiscard]] ScoreModel load_score(const std::filesystem::path& file);

/// Describes a model's training data; a model of scripted operators states that it has seen no human data.
[[nodiscard]] std::string training_statement(const ScoreModel& model);
[[nodiscard]] nlohmann::ordered_json to_json(const Score& score, const ScoreModel& model);
/// Plain text.
[[nodiscard]] std::string to_table(const Score& score, const ScoreModel& model);
[[nodiscard]] std::string to_table(const ScoreModel& model);
/// A self-contained page with the calibration plot and the weights.
[[nodiscard]] std::string to_html(const ScoreModel& model);

/// Reads a training example from a session file. `label` "skill": graded by the skill of its scripted
/// operator, or 1 if the trachea was not intubated; otherwise by the mean rating of that item. Returns
/// nullopt if the file has no such grade, or its outcome is unknown.
[[nodiscard]] std::optional<Example> read_example(const std::filesystem::path& file,
                                                  const std::string& label);

}  // namespace eti::review
