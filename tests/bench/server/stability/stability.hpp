// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/server/shard.hpp"

namespace eti::bench {

struct StabilityOptions {
    std::filesystem::path out = "out/bench";
    bool quick = false;  ///< the shipped setting only, for tests
    std::string only;    ///< one part by name; empty: all
    Shard shard;         ///< share of the runs
};

/// Valid values of `only`.
[[nodiscard]] std::vector<std::string> stability_part_names();

/// Where methods survive, recover or fail: blocks of tissue deformed and released, clusters without volume
/// and conflicting constraints, the blade driven into tissue on bone, tube and blade against thin walls, the
/// head moved in one step, and fluid in a closing gap. Writes stability.csv. Returns the program's exit code.
[[nodiscard]] int stability(const StabilityOptions& options);

}  // namespace eti::bench
