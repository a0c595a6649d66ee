// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/session/opinions.hpp"

namespace eti::review {

/// A questionnaire, from a file of deploy/data/forms: see docs/study.md.
struct Form {
    enum class Kind : std::uint8_t { scale, yes_no, words };
    struct Question {
        std::string name;  ///< in files
        std::string ask;
        Kind kind = Kind::scale;
        std::string low, high;  ///< labels of the ends of a scale
    };
    std::string name, title, source;
    std::vector<Question> questions;
};

/// Throws InputError.
[[nodiscard]] Form load_form(const std::filesystem::path& file);

/// Describes the valid answers to a question, for a prompt or a message.
[[nodiscard]] std::string expected_answer(const Form::Question& question);

/// Whether the answer is valid. Words are at most 500 bytes without control characters.
[[nodiscard]] bool is_valid_answer(const Form::Question& question, const std::string& answer);

/// Reads answers from a YAML file: one line per question, with its name and answer; omitted questions stay
/// unanswered. Throws InputError.
[[nodiscard]] std::vector<session::Answer> load_answers(const Form& form, const std::filesystem::path& file);

}  // namespace eti::review
