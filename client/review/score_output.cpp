// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "client/review/output.hpp"
#include "client/review/score.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti::review {

namespace {

std::string label_of(const ScoreFeature& feature) {
    if (feature.key == intubated_key) {
        return "trachea intubated";
    }
    const std::string label(metric_field(feature.key).label);
    return feature.subtracted.empty() ? label : label + ", difference from the weight rule";
}

/// Features by weight, largest first.
std::vector<std::size_t> by_size(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](std::size_t i) { return std::abs(values[i]); });
    return order;
}

/// To six digits, as in a file, and never minus zero.
double shown(double value) {
    return std::round(1e6 * value) / 1e6 + 0.0;
}

/// A separately judged group, with its name in a file.
template <class Judged>
auto groups_of(Judged& judged) {
    return std::array{std::pair("all", &judged.all), std::pair("intubated", &judged.intubated)};
}

std::vector<double> weights_of(const ScoreModel& model) {
    std::vector<double> weights;
    for (const ScoreModel::Weight& weight : model.weights) {
        weights.push_back(weight.weight);
    }
    return weights;
}

}  // namespace

std::string training_statement(const ScoreModel& model) {
    const std::string learnt =
        fmt::format("Fitted to {} sessions of {} operators with {} patients, graded by {}.", model.sessions,
                    model.persons, model.patients, model.source);
    return model.human_rated ? learnt
                             : learnt +
                                   " No human data was used: it measures how close a session is to a skilled "
                                   "script, not how good a person is.";
}

std::string to_yaml(const ScoreModel& model) {
    std::string out = "# Written by `eti-review score train`; see docs/score.md.\n";
    out += fmt::format("name: {}\nsource: \"{}\"\npeople: {}\n", model.name, model.source,
                       model.human_rated ? "on" : "off");
    out += fmt::format("sessions: {}\npatients: {}\npersons: {}\npenalty: {:.6g}\n", model.sessions,
                       model.patients, model.persons, model.penalty);
    out += "thresholds:\n";
    for (const double threshold : model.thresholds) {
        out += fmt::format("  - {{above: {:.6f}}}\n", threshold);
    }
    out += "features:\n";
    for (std::size_t j = 0; j < model.weights.size(); ++j) {
        const ScoreModel::Weight& w = model.weights[j];
        out += fmt::format(
            "  - {{key: {}, mean: {:.6f}, deviation: {:.6f}, low: {:.6f}, high: {:.6f}, weight: {:.6f}}}\n",
            score_features()[j].key, w.mean, w.deviation, w.low, w.high, shown(w.weight));
    }
    const ValidationResult& j = model.validation;
    out += "judged:\n";
    for (const auto& [name, error] : groups_of(j)) {
        out += fmt::format("  {}: {{sessions: {}, mean_error: {:.4f}, blind_error: {:.4f}, rank: {:.4f}}}\n",
                           name, error->sessions, error->mean_error, error->baseline_error, error->rank);
    }
    out += fmt::format("  right: {:.4f}\n  blind_right: {:.4f}\n  brier: {:.4f}\n  calibration:\n",
                       j.accuracy, j.baseline_accuracy, j.brier);
    for (const CalibrationBin& bin : j.calibration) {
        out += fmt::format("    - {{count: {}, predicted: {:.4f}, observed: {:.4f}}}\n", bin.count,
                           bin.predicted, bin.observed);
    }
    return out;
}

ScoreModel load_score(const std::filesystem::path& file) {
    YamlMap root = YamlMap::parse(read_text_file(file), file.string());
    constexpr int most = 1'000'000;
    const Range any{-1e6f, 1e6f};
    const auto number = [&](YamlMap& map, const std::string& key, const Range& range) {
        if (!map.has(key)) {
            map.refuse(key, "nothing", "a number; 'eti-review score train' writes it");
        }
        return static_cast<double>(map.number(key, 0.0f, range));
    };
    ScoreModel model;
    model.name = root.name("name", file.stem().string());
    model.source = root.text("source", "");
    model.human_rated = root.flag("people", false);
    model.sessions = static_cast<std::size_t>(root.whole("sessions", 0, 0, most));
    model.patients = static_cast<std::size_t>(root.whole("patients", 0, 0, most));
    model.persons = static_cast<std::size_t>(root.whole("persons", 0, 0, most));
    model.penalty = number(root, "penalty", {0, 1e6f});
    std::vector<YamlMap> thresholds = root.list("thresholds");
    if (thresholds.size() != model.thresholds.size()) {
        root.refuse("thresholds", std::to_string(thresholds.size()),
                    fmt::format("{} of them, between {} grades", model.thresholds.size(), grades));
    }
    for (std::size_t k = 0; k < thresholds.size(); ++k) {
        model.thresholds[k] = number(thresholds[k], "above", any);
        if (k > 0 && model.thresholds[k] < model.thresholds[k - 1]) {
            thresholds[k].refuse("above", fmt::format("{:g}", model.thresholds[k]),
                                 "at least the previous threshold");
        }
        thresholds[k].finish();
    }
    std::vector<YamlMap> features = root.list("features");
    if (features.size() != score_features().size()) {
        root.refuse(
            "features", std::to_string(features.size()),
            fmt::format("{} of them; train the score again with this version", score_features().size()));
    }
    for (std::size_t j = 0; j < features.size(); ++j) {
        YamlMap& one = features[j];
        if (const std::string key = one.name("key", ""); key != score_features()[j].key) {
            one.refuse("key", key,
                       fmt::format("{}; train the score again with this version", score_features()[j].key));
        }
        ScoreModel::Weight weight;
        weight.mean = number(one, "mean", any);
        weight.deviation = number(one, "deviation", {1e-6f, 1e6f});
        weight.low = number(one, "low", any);
        weight.high = number(one, "high", any);
        weight.weight = number(one, "weight", any);
        if (weight.high < weight.low) {
            one.refuse("high", fmt::format("{:g}", weight.high), "at least 'low'");
        }
        const bool more_is_better = score_features()[j].more_is_better;
        if (more_is_better ? weight.weight < 0.0 : weight.weight > 0.0) {
            one.refuse("weight", fmt::format("{:g}", weight.weight),
                       more_is_better ? "0 or more, as larger values are better"
                                      : "0 or less, as larger values are not better");
        }
        one.finish();
        model.weights.push_back(weight);
    }
    if (auto judged = root.map("judged")) {
        ValidationResult& j = model.validation;
        for (const auto& [name, error] : groups_of(j)) {
            if (auto one = judged->map(name)) {
                error->sessions = static_cast<std::size_t>(one->whole("sessions", 0, 0, most));
                error->mean_error = number(*one, "mean_error", {0, grades});
                error->baseline_error = number(*one, "blind_error", {0, grades});
                error->rank = number(*one, "rank", {-1, 1});
                one->finish();
            }
        }
        j.accuracy = number(*judged, "right", {0, 1});
        j.baseline_accuracy = number(*judged, "blind_right", {0, 1});
        j.brier = number(*judged, "brier", {0, 1});
        std::vector<YamlMap> bins = judged->list("calibration");
        if (bins.size() != j.calibration.size()) {
            judged->refuse("calibration", std::to_string(bins.size()), std::to_string(j.calibration.size()));
        }
        for (std::size_t i = 0; i < bins.size(); ++i) {
            j.calibration[i] = {static_cast<std::size_t>(bins[i].whole("count", 0, 0, most)),
                                number(bins[i], "predicted", {0, 1}), number(bins[i], "observed", {0, 1})};
            bins[i].finish();
        }
        judged->finish();
    }
    root.finish();
    return model;
}

nlohmann::ordered_json to_json(const Score& score, const ScoreModel& model) {
    nlohmann::ordered_json out{{"grade", score.grade},
                               {"of", grades},
                               {"chance", score.chance},
                               {"model", model.name},
                               {"statement", training_statement(model)},
                               {"contributions", nlohmann::ordered_json::array()}};
    for (const std::size_t j : by_size(score.contributions)) {
        out["contributions"].push_back({{"key", score_features()[j].key},
                                        {"label", label_of(score_features()[j])},
                                        {"measured", static_cast<bool>(score.measured[j])},
                                        {"log_odds", score.contributions[j]}});
    }
    return out;
}

std::string to_table(const Score& score, const ScoreModel& model) {
    std::string out = fmt::format("Score {:.1f} of {}, by '{}'\n", score.grade, grades, model.name);
    out += "  probabilities of grades 1 to 5:";
    for (const double chance : score.chance) {
        out += fmt::format(" {:.0f} %", 100.0 * chance);
    }
    out += "\n";
    for (const std::size_t j : by_size(score.contributions)) {
        out += fmt::format("  {:+7.2f}  {}{}\n", shown(score.contributions[j]), label_of(score_features()[j]),
                           score.measured[j] ? "" : ": not reached, counted as the worst value");
    }
    return out + fmt::format("{}\n", training_statement(model));
}

std::string to_table(const ScoreModel& model) {
    const ValidationResult& j = model.validation;
    std::string out = fmt::format("{}\n", training_statement(model));
    out += "Cross-validated on sessions of patients and operators that were left out of the fit:\n";
    for (const auto& [name, error] : groups_of(j)) {
        out += fmt::format(
            "  {} {}: error {:.2f} grades (predicting their mean: {:.2f}); rank correlation {:.2f}\n",
            error->sessions, name, error->mean_error, error->baseline_error, error->rank);
    }
    out += fmt::format(
        "  grade 4 or 5 classified correctly in {:.0f} % (predicting the more frequent: {:.0f} %); Brier "
        "{:.3f}\n",
        100.0 * j.accuracy, 100.0 * j.baseline_accuracy, j.brier);
    out += fmt::format("  {:>10}{:>12}{:>12}\n", "sessions", "predicted", "observed");
    for (const CalibrationBin& bin : j.calibration) {
        if (bin.count > 0) {
            out += fmt::format("  {:>10}{:>10.0f} %{:>10.0f} %\n", bin.count, 100.0 * bin.predicted,
                               100.0 * bin.observed);
        }
    }
    out += "Weights, in log odds of a better grade per standard deviation:\n";
    for (const std::size_t i : by_size(weights_of(model))) {
        out += fmt::format("  {:+7.2f}  {}\n", shown(model.weights[i].weight), label_of(score_features()[i]));
    }
    return out;
}

std::string to_html(const ScoreModel& model) {
    // Position of the plot in the drawing's user units.
    constexpr double left = 40, top = 10, size = 300;
    std::string points;
    for (const CalibrationBin& bin : model.validation.calibration) {
        if (bin.count > 0) {
            const double x = left + size * bin.predicted, y = top + size * (1.0 - bin.observed);
            points += fmt::format(
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"#00705c\"/>"
                "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"12\">{}</text>\n",
                x, y, x + 8, y + (bin.observed > 0.9 ? 14 : -6), bin.count);
        }
    }
    return html_page(
        "Score " + model.name,
        fmt::format("<h1>Score {0}</h1>\n<pre>{1}</pre>\n<h2>Calibration</h2>\n"
                    "<svg viewBox=\"0 0 360 360\" width=\"480\" role=\"img\" aria-label=\"Predicted "
                    "probability of grade 4 or 5 and the observed share\">\n"
                    "<rect x=\"{2}\" y=\"{3}\" width=\"{4}\" height=\"{4}\" fill=\"none\" stroke=\"#333\"/>\n"
                    "<line x1=\"{2}\" y1=\"{5}\" x2=\"{6}\" y2=\"{3}\" stroke=\"#999\" "
                    "stroke-dasharray=\"4\"/>\n{7}<text x=\"{8}\" y=\"345\" font-size=\"13\" "
                    "text-anchor=\"middle\">predicted probability of grade 4 or 5</text>\n"
                    "<text x=\"20\" y=\"160\" font-size=\"13\" text-anchor=\"middle\" transform=\"rotate(-90 "
                    "20 160)\">observed share</text>\n</svg>\n<p>Numbers are sessions; on the dashed line "
                    "probability and share are equal.</p>\n",
                    html_text(model.name), html_text(to_table(model)), left, top, size, top + size,
                    left + size, points, left + size / 2));
}

}  // namespace eti::review
