// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <vector>

#include "common/process/command_line.hpp"

namespace eti::review {

/// A subcommand of eti-review; `run` returns the exit status.
struct Command {
    CommandLine parser;
    std::function<int(bool json)> run;
};

// Commands for studies of many sessions, see docs/study.md. Options live as long as the returned commands.

/// compare, anonymise.
[[nodiscard]] std::vector<Command> add_study_commands(CommandLine& app);
/// rate, agreement, questionnaire.
[[nodiscard]] std::vector<Command> add_rating_commands(CommandLine& app);
/// score train, score apply.
[[nodiscard]] std::vector<Command> add_score_commands(CommandLine& app);

}  // namespace eti::review
