// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::bench {

/// A file of the source tree, in which the program was built: `path` is relative to the tree's root.
[[nodiscard]] inline std::filesystem::path source_file(const std::filesystem::path& path) {
    // ROOT/build/PRESET/bin/PROGRAM
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "../../.." / path;
}

}  // namespace eti::bench
