// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::session {

struct CheckResult {
    std::vector<std::string> damage;   ///< what other programs or we stumble over; empty: sound
    std::vector<std::string> remarks;  ///< what is worth knowing
    bool repairable = false;           ///< repair() mends all the damage
    [[nodiscard]] bool sound() const { return damage.empty(); }
};

/// Reads everything in a session file. Throws hdf5::Error for what is no session file at all.
[[nodiscard]] CheckResult check(const std::filesystem::path& path);

/// Makes a file that any HDF5 program opens and whose series are of equal length. A mark of a killed writer
/// is cleared in place. Where rows are damaged, what every series still holds goes into a new file, which
/// names in `damage` what is lost; it takes the old one's place, which is kept as FILE.before-repair. Says
/// what it did. Leaves a file alone that a running program writes. Throws hdf5::Error when it cannot mend
/// the file.
[[nodiscard]] std::vector<std::string> repair(const std::filesystem::path& path);

}  // namespace eti::session
