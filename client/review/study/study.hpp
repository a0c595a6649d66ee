// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/review/comparison.hpp"

namespace eti::review {

/// A published finding that a comparison is checked against.
struct Expectation {
    std::string measure;  ///< key of a metric, or success_percent
    std::string source;
    // Either a direction from one group to another,
    std::string from, to;
    bool more = true;  ///< else less
    // or a range for a group's mean.
    std::string group;
    double low = no_value, high = no_value;
    [[nodiscard]] bool is_range() const { return !group.empty(); }
};

/// A study, from a file of deploy/data/studies: see docs/study.md.
struct Study {
    struct Condition {
        std::string name;
        std::string scenario;  ///< by name or path
    };
    struct Participant {
        std::string name;       ///< pseudonym: P01, P02, ...
        std::string operator_;  ///< scripted operator; empty: a person
        std::uint64_t seed = 0;
        // For a scripted operator; nullopt: as in its file.
        std::optional<float> skill;
        std::optional<int> attempts;
    };
    std::string name, description;
    std::string text;  ///< the file's content
    std::vector<Condition> conditions;
    std::vector<Participant> participants;
    bool latin_square = true;  ///< else everyone runs the conditions as listed
    std::vector<Expectation> expectations;
};

/// Throws InputError.
[[nodiscard]] Study load_study(const std::filesystem::path& file);

/// Balanced orders of `count` conditions: each occurs equally often in each position and follows each other
/// one equally often (Williams 1949, Aust J Chem 2:149). `count` rows, twice as many for an odd count.
[[nodiscard]] std::vector<std::vector<std::size_t>> balanced_orders(std::size_t count);

/// A session of a study.
struct PlannedSession {
    const Study::Participant* participant = nullptr;
    const Study::Condition* condition = nullptr;
    std::size_t place = 0;       ///< position among the participant's sessions, from 1
    std::filesystem::path file;  ///< relative to the study's folder
};

/// All sessions in execution order: one participant after the other. Points into `study`.
[[nodiscard]] std::vector<PlannedSession> plan_of(const Study& study);

/// Comparison of a finding with its expectation.
struct ExpectationResult {
    enum class Finding : std::uint8_t { agrees, disagrees, undecided, not_measured };
    Expectation expected;
    Finding finding = Finding::not_measured;
    std::string found;  ///< the numbers found
};

/// `agrees` and `disagrees` if the test rejects "no difference" (the interval, its dual, excludes zero), or,
/// for a range, by the mean.
[[nodiscard]] std::vector<ExpectationResult> check_expectations(const Comparison& comparison,
                                                                const std::vector<Expectation>& expectations);

[[nodiscard]] std::string to_table(const std::vector<ExpectationResult>& verdicts);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<ExpectationResult>& verdicts);
/// A heading and a table for to_html(Comparison); empty for no results.
[[nodiscard]] std::string to_html(const std::vector<ExpectationResult>& verdicts);

/// Exit status after Ctrl+C, by shell convention.
inline constexpr int interrupted = 130;

/// Options for running a study's sessions.
struct StudyRun {
    std::filesystem::path folder;
    std::string participant;                  ///< run only this participant's sessions; empty: all
    bool status_only = false;                 ///< print the status and run nothing
    std::vector<std::string> server_options;  ///< options for eti-server
};

/// Runs the pending sessions one after another with eti-server. Updates plan.csv in the folder after each.
/// An interrupted session is set aside and repeated. Prints a line per session. Returns the exit status.
/// Throws InputError, ExportError.
[[nodiscard]] int run_study(const Study& study, const StudyRun& how, bool json);

}  // namespace eti::review
