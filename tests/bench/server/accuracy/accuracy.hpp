// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/server/shard.hpp"

namespace eti::bench {

struct AccuracyOptions {
    std::filesystem::path out = "out/bench";
    bool quick = false;  ///< a corner of the sweep, for tests
    std::string only;    ///< one of accuracy_group_names(); all if empty
    Shard shard;         ///< share of the runs
};

/// Groups of cases, in the order in which they run.
[[nodiscard]] std::vector<std::string> accuracy_group_names();

/// Error against cost of every method, spacing, number of substeps and of iterations, in cases with a
/// reference. Writes accuracy.csv, and accuracy-forces.csv with the force-depth curves behind the errors of
/// the indentations. Returns the program's exit code.
[[nodiscard]] int accuracy(const AccuracyOptions& options);

}  // namespace eti::bench
