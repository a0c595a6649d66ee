// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/hdf5/group.hpp"

// Ratings and questionnaires after a session: groups `ratings` and `answers` of its file.

namespace eti::session {

inline constexpr const char* ratings_group = "ratings";
inline constexpr const char* answers_group = "answers";

inline constexpr int lowest_score = 1, highest_score = 5;

/// An instructor's rating of one item.
struct Rating {
    std::string rater, item;
    std::uint8_t score = 0;  ///< lowest_score (worst) to highest_score (best)
    std::string given;       ///< UTC, ISO 8601; empty when anonymised
};

/// A participant's answer to one question.
struct Answer {
    std::string form, question;  ///< names
    std::string text;            ///< the question as asked
    std::string answer;          ///< a score as its digit, "yes" or "no", or free text
    std::string given;
};

/// Empty for a file without them. Throws hdf5::Error.
[[nodiscard]] std::vector<Rating> read_ratings(const hdf5::Group& root);
[[nodiscard]] std::vector<Answer> read_answers(const hdf5::Group& root);

/// Adds ratings to a session file; a rating by the same rater of the same item replaces the old one. The file
/// is replaced atomically. Rejects a file that is being recorded or needs repair. Throws hdf5::Error.
void add_ratings(const std::filesystem::path& file, const std::vector<Rating>& ratings);
/// The same for answers; one replaces an older answer to the same question of the same form.
void add_answers(const std::filesystem::path& file, const std::vector<Answer>& answers);

/// The current time, UTC, ISO 8601.
[[nodiscard]] std::string utc_now();

}  // namespace eti::session
