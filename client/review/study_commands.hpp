// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <vector>

namespace eti::review {

/// A subcommand of eti-review; `run` gives the exit status.
struct Command {
    CLI::App* parsed_by = nullptr;
    std::function<int(bool json)> run;
};

// Commands for studies of many sessions, see docs/study.md. Options live as long as what is returned.

/// compare, anonymise.
[[nodiscard]] std::vector<Command> add_study_commands(CLI::App& app);
/// rate, agreement, questionnaire.
[[nodiscard]] std::vector<Command> add_opinion_commands(CLI::App& app);
/// score train, score apply.
[[nodiscard]] std::vector<Command> add_score_commands(CLI::App& app);

}  // namespace eti::review
