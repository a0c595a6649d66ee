// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <vector>

#include "common/process/command_line.hpp"

namespace eti::review {

/// A subcommand of eti-review; `run` gives the exit status.
struct Command {
    CommandLine parsed_by;
    std::function<int(bool json)> run;
};

// Commands for studies of many sessions, see docs/study.md. Options live as long as what is returned.

/// compare, anonymise.
[[nodiscard]] std::vector<Command> add_study_commands(CommandLine& app);
/// rate, agreement, questionnaire.
[[nodiscard]] std::vector<Command> add_opinion_commands(CommandLine& app);
/// score train, score apply.
[[nodiscard]] std::vector<Command> add_score_commands(CommandLine& app);

}  // namespace eti::review
