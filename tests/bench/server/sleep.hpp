// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::bench {

struct SleepOptions {
    std::filesystem::path out = "out/bench";
    std::vector<std::string> scenarios = {"term"};
    bool quick = false;  ///< the shipped model only, and two seconds of the attempt, for tests
};

/// What an attempt loses, and what a step saves, where tissue at rest sleeps: the scripted expert's way, as
/// it went where nothing sleeps, is taken again where it does, and four times more with the blade led a
/// micrometre beside (left, right, up, down), as a measure of what any small cause makes of forces that stick
/// and slip. Writes sleep.csv, one row per scenario and model of the tongue: means, root mean squares of the
/// differences, and the share of the time that differs by more than 0.5 % of the greatest; and
/// sleep-course.csv, ten rows a second. Returns the program's exit code.
[[nodiscard]] int sleep(const SleepOptions& options);

}  // namespace eti::bench
