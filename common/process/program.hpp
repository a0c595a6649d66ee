// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/process/command_line.hpp"
#include "common/process/stop_signal.hpp"

namespace eti {

/// Body of a program's main: logs under the program's name, catches the stop signals, and runs `work` if
/// `parse` returns no exit status. Logs the text of an exception. Returns the exit status. nullopt for
/// programs that never ask for stop_requested(): a signal ends them.
[[nodiscard]] int run_program(const std::string& name, const std::function<std::optional<int>()>& parse,
                              const std::function<int()>& work,
                              const std::optional<StopSignals>& how = StopSignals{});

/// The same after a program's options have been declared.
[[nodiscard]] int run_program(CommandLine& app, int argc, char** argv, const std::function<int()>& work,
                              const std::optional<StopSignals>& how = StopSignals{});

/// If `wanted`, prints a program's result to standard output; U+FFFD stands for bytes that are not UTF-8.
void print_json(bool wanted, const nlohmann::ordered_json& result);

}  // namespace eti
