// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::session {

struct CheckResult {
    std::vector<std::string> damage;   ///< what prevents reading the file; empty: sound
    std::vector<std::string> remarks;  ///< further information
    bool repairable = false;           ///< repair() fixes all the damage
    [[nodiscard]] bool is_valid() const { return damage.empty(); }
};

/// Reads everything in a session file. Throws hdf5::Error if it is not a session file.
[[nodiscard]] CheckResult check(const std::filesystem::path& path);

/// Makes a file that any HDF5 program opens and whose series have equal length. A killed writer's open mark
/// is cleared in place. If rows are damaged, the readable rows of every series are written to a new file,
/// which lists the lost ones in `damage` and replaces the old file; that is kept as FILE.before-repair.
/// Returns a description of what was done. Leaves a file alone that a running program writes. Throws
/// hdf5::Error if it cannot repair the file.
[[nodiscard]] std::vector<std::string> repair(const std::filesystem::path& path);

}  // namespace eti::session
