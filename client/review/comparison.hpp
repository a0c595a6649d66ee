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
    std::string participant;  ///< pseudonym; empty where the file names none
    Parameters parameters;    ///< of the run
    Outcome outcome;
};

struct StudyGroup {
    std::string name;
    std::vector<StudySession> sessions;
};

/// What is compared: whether the trachea was intubated [%], then every parameter.
struct Measure {
    std::string_view key, label, unit;
    bool in_paper;
    double Parameters::*value;  ///< null: success
    [[nodiscard]] double of(const StudySession& session) const;
};
[[nodiscard]] const std::vector<Measure>& measures();

/// A measure in two groups, second less first.
struct Contrast {
    std::size_t first = 0, second = 0;  ///< groups
    std::size_t pairs = 0;              ///< that both have a value; 0 unless paired
    Difference difference;
    double p_adjusted = no_value;  ///< for all measures of the paper, or all others, between these two groups
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

/// Sessions compared by group, as Table 2 of Xiao et al. 2020 does.
struct Comparison {
    std::vector<StudyGroup> groups;
    bool paired = false;
    Bootstrap how;
    std::vector<MeasureRow> rows;      ///< measures that exist in no session are left out
    std::vector<std::string> remarks;  ///< what was left out, and why
};

/// Groups that cannot be compared; the text says what was found, what was expected, and what to do.
class ComparisonError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Each group's name and files, as given.
using GroupFiles = std::vector<std::pair<std::string, std::vector<std::filesystem::path>>>;

/// Reads the groups' sessions. One that was cut off, whose outcome is not known, is left out with a remark.
/// `progress` is called before each file. Throws hdf5::Error, ComparisonError.
[[nodiscard]] Comparison read_groups(const GroupFiles& files,
                                     const std::function<void(const std::filesystem::path&)>& progress);

/// Fills in rows. With `paired` set the sessions of two groups belong together by participant, or, where no
/// file names one, by their order. Throws ComparisonError.
void compare(Comparison& comparison);

/// For people to read, within 110 columns.
[[nodiscard]] std::string to_table(const Comparison& comparison);
/// One object; NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const Comparison& comparison);
/// A row for each session (RFC 4180).
[[nodiscard]] std::string to_csv(const Comparison& comparison);
/// One page that opens offline and fetches nothing. `further`: HTML that stands before the list of sessions.
[[nodiscard]] std::string to_html(const Comparison& comparison, std::string_view further = {});

}  // namespace eti::review
