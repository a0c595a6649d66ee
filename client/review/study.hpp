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

/// What a publication found, to which a comparison is held.
struct Expectation {
    std::string measure;  ///< key of a parameter, or success_percent
    std::string source;
    // Either a direction from one group to another,
    std::string from, to;
    bool more = true;  ///< else less
    // or where the mean of a group lies.
    std::string group;
    double low = no_value, high = no_value;
    [[nodiscard]] bool is_range() const { return !group.empty(); }
};

/// A study, as a file of deploy/studies says it: see docs/study.md.
struct Study {
    struct Condition {
        std::string name;
        std::string scenario;  ///< by name or path
    };
    struct Participant {
        std::string name;       ///< pseudonym: P01, P02, ...
        std::string operator_;  ///< scripted; empty: a person
        std::uint64_t seed = 0;
        // Of a scripted operator; nothing: as its file says.
        std::optional<float> skill;
        std::optional<int> attempts;
    };
    std::string name, description;
    std::string text;  ///< the file as read
    std::vector<Condition> conditions;
    std::vector<Participant> participants;
    bool latin_square = true;  ///< else everybody goes through the conditions as listed
    std::vector<Expectation> expectations;
};

/// Throws InputError.
[[nodiscard]] Study load_study(const std::filesystem::path& file);

/// Orders of `count` conditions in which each comes equally often at each place and, neighbours taken in
/// order, after each other one (Williams 1949, Aust J Chem 2:149): `count` rows, twice as many for an odd
/// count.
[[nodiscard]] std::vector<std::vector<std::size_t>> balanced_orders(std::size_t count);

/// A session of a study.
struct PlannedSession {
    const Study::Participant* participant = nullptr;
    const Study::Condition* condition = nullptr;
    std::size_t place = 0;       ///< of the participant's sessions, from 1
    std::filesystem::path file;  ///< below the study's folder
};

/// All sessions in the order in which they run: one participant after the other. Points into `study`.
[[nodiscard]] std::vector<PlannedSession> plan_of(const Study& study);

/// How a comparison's finding stands to what was expected.
struct Verdict {
    enum class Word : std::uint8_t { agrees, disagrees, undecided, not_measured };
    Expectation expected;
    Word word = Word::not_measured;
    std::string found;  ///< in numbers
};

/// `agrees` and `disagrees` where the interval of the difference leaves zero out, or, for a range, by the
/// mean.
[[nodiscard]] std::vector<Verdict> judge(const Comparison& comparison,
                                         const std::vector<Expectation>& expectations);

[[nodiscard]] std::string to_table(const std::vector<Verdict>& verdicts);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Verdict>& verdicts);
/// A heading and a table for to_html(Comparison); empty for no verdicts.
[[nodiscard]] std::string to_html(const std::vector<Verdict>& verdicts);

/// Exit status after Ctrl+C, as a shell gives it.
inline constexpr int interrupted = 130;

/// How sessions of a study are run.
struct StudyRun {
    std::filesystem::path folder;
    std::string participant;           ///< run this one's sessions alone; empty: all
    bool status_only = false;          ///< say where it is, and run nothing
    std::vector<std::string> further;  ///< options for eti-server
};

/// Runs the sessions that are not done yet, one after another, by eti-server. After each the folder's
/// plan.csv says where the study is. One that was cut off is kept aside and done anew. Prints a line for
/// each. Returns the exit status. Throws InputError, ExportError.
[[nodiscard]] int run_study(const Study& study, const StudyRun& how, bool json);

}  // namespace eti::review
