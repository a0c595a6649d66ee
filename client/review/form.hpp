// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/session/opinions.hpp"

namespace eti::review {

/// A questionnaire, as a file of deploy/forms says it: see docs/study.md.
struct Form {
    enum class Kind : std::uint8_t { scale, yes_no, words };
    struct Question {
        std::string name;  ///< in files
        std::string ask;
        Kind kind = Kind::scale;
        std::string low, high;  ///< what the ends of a scale mean
    };
    std::string name, title, source;
    std::vector<Question> questions;
};

/// Throws InputError.
[[nodiscard]] Form load_form(const std::filesystem::path& file);

/// What a question may be answered with, for a prompt or a message.
[[nodiscard]] std::string expected_answer(const Form::Question& question);

/// Whether it may be answered so. Words are at most 500 bytes without control characters.
[[nodiscard]] bool acceptable(const Form::Question& question, const std::string& answer);

/// Answers from a YAML file: a question's name and its answer in each line; those left out stay unanswered.
/// Throws InputError.
[[nodiscard]] std::vector<session::Answer> load_answers(const Form& form, const std::filesystem::path& file);

}  // namespace eti::review
