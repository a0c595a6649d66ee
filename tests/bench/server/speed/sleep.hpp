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
    bool quick = false;  ///< two seconds of the attempt only, for tests
};

/// Accuracy lost in an attempt, and time saved in a step, where tissue at rest sleeps. The scripted expert's
/// path, recorded without sleeping, is replayed with it. Four more replays shift the blade by a micrometre
/// (left, right, up, down), as a measure of how stick-slip forces respond to any small cause. Writes
/// sleep.csv, one row per scenario: means, RMS of the differences, and the share of
/// the time that differs by more than 0.5 % of the maximum. Writes sleep-course.csv, ten rows a second.
/// Returns the program's exit code.
[[nodiscard]] int sleep(const SleepOptions& options);

}  // namespace eti::bench
