// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"

namespace eti::review {

/// Summary of a session file.
struct Summary {
    std::filesystem::path file;
    session::SessionInfo info;
    double duration = 0.0;  ///< [s], simulation time
    bool finished = false;  ///< recorded to its end
    bool live = false;      ///< being recorded
    std::uint64_t lost_records = 0;
    bool has_run = false;  ///< whether the file holds a summary of the run
    /// Without a summary the outcome is unknown: the reason states what is known, and the metrics are those
    /// of the last step. NaN for means over several attempts, whose weights a file does not contain.
    session::SummaryRecord run;
    std::vector<session::SummaryRecord> attempts;
    std::uint32_t unfinished_attempt = 0;  ///< attempt in progress when the recording ended; 0: none
    [[nodiscard]] bool outcome_known(const session::SummaryRecord& record) const {
        return record.outcome.known && (record.attempt == 0 ? has_run : record.attempt != unfinished_attempt);
    }
    std::vector<session::EventRecord> remarks;  ///< notes, pointers and drawings, as text
    std::vector<session::Rating> ratings;       ///< by instructors, after the session
    std::vector<session::Answer> answers;       ///< of the participant to questionnaires
};

/// Simulation time of a step [s].
[[nodiscard]] inline double seconds_of(const session::StepRecord& step) {
    return 1e-9 * static_cast<double>(step.time_ns);
}

/// Throws hdf5::Error.
[[nodiscard]] Summary summarise(const std::filesystem::path& file);

/// Adds a session's names, version, duration and recording status to an object.
void put_session(nlohmann::ordered_json& into, const Summary& summary);

/// "success", "no success" or "unknown".
[[nodiscard]] std::string_view outcome_word(const Summary& summary, const session::SummaryRecord& record);

/// One object; NaN becomes null, as does an unknown success.
[[nodiscard]] nlohmann::ordered_json to_json(const Summary& summary);

[[nodiscard]] nlohmann::ordered_json ratings_json(const std::vector<session::Rating>& ratings);
[[nodiscard]] nlohmann::ordered_json answers_json(const std::vector<session::Answer>& answers);

/// Plain text: the twelve parameters of the paper first, then the other metrics; one column for the run and
/// one per attempt.
[[nodiscard]] std::string to_table(const Summary& summary);

}  // namespace eti::review
