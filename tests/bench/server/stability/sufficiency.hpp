// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/server/shard.hpp"

namespace eti::bench {

struct SufficiencyOptions {
    std::filesystem::path out = "out/bench";
    std::vector<std::string> scenarios = {"term", "premature"};
    bool quick = false;  ///< two variants instead of all, for tests
    int seeds = 3;       ///< of the operator's tremor, to estimate the scatter
    Shard shard;         ///< share of the runs
};

/// How the outcome of a scripted intubation changes as the model shrinks: writes sufficiency.csv, one
/// row per scenario and variant. Returns the program's exit code.
[[nodiscard]] int sufficiency(const SufficiencyOptions& options);

}  // namespace eti::bench
