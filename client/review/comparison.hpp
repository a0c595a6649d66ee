// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/review/statistics.hpp"
#include "client/review/summary.hpp"

namespace eti::review {

/// One session of a study.
struct StudySession {
    std::filesystem::path file;
    session::SessionInfo info;
    std::string participant;  ///< pseudonym; empty if the file has none
    AttemptMetrics metrics;   ///< of the run
    Outcome outcome;
};

struct StudyGroup {
    std::string name;
    std::vector<StudySession> sessions;
};

/// A compared quantity: intubation success [%], then every metric.
struct Measure {
    std::string_view key, label, unit;
    bool in_paper;
    double AttemptMetrics::*value;  ///< null: success
    [[nodiscard]] double of(const StudySession& session) const;
};
[[nodiscard]] const std::vector<Measure>& measures();

/// A measure in two groups, second minus first.
struct Contrast {
    std::size_t first = 0, second = 0;  ///< group indices
    std::size_t pairs = 0;              ///< pairs in which both have a value; 0 unless paired
    Difference difference;
    double p_adjusted = no_value;  ///< over all measures of the paper, or all others, between these two
                                   ///< groups
};

struct MeasureRow {
    const Measure* measure = nullptr;
    struct Cell {
        std::size_t count = 0;  ///< sessions in which the value exists
        double mean = no_value, deviation = no_value;
    };
    std::vector<Cell> groups;
    std::vector<Contrast> contrasts;
};

/// Sessions compared by group, as in Table 2 of Xiao et al. 2020.
struct Comparison {
    std::vector<StudyGroup> groups;
    bool paired = false;
    Bootstrap how;
    std::vector<MeasureRow> rows;      ///< measures without a value in any session are omitted
    std::vector<std::string> remarks;  ///< what was omitted, and why
};

/// Groups that cannot be compared; the message states what was found, what was expected, and the remedy.
class ComparisonError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Name and files of each group, as given.
using GroupFiles = std::vector<std::pair<std::string, std::vector<std::filesystem::path>>>;

/// Reads the groups' sessions. Interrupted sessions, whose outcome is unknown, are omitted with a remark.
/// `progress` is called before each file. Throws hdf5::Error, ComparisonError.
[[nodiscard]] Comparison read_groups(const GroupFiles& files,
                                     const std::function<void(const std::filesystem::path&)>& progress);

/// Computes rows. If `paired` is set, sessions of two groups are paired by participant, or by order if no
/// file names one. Throws ComparisonError.
void compare(Comparison& comparison);

/// Plain text, within 110 columns.
[[nodiscard]] std::string to_table(const Comparison& comparison);
/// One object; NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const Comparison& comparison);
/// One row per session (RFC 4180).
[[nodiscard]] std::string to_csv(const Comparison& comparison);
/// A self-contained HTML page that works offline. `extra_html`: HTML inserted before the list of sessions.
[[nodiscard]] std::string to_html(const Comparison& comparison, std::string_view extra_html = {});

}  // namespace eti::review
