// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

namespace eti {

/// Describes a path that is not a regular file: "a folder", "a pipe", "a device", "a socket" or "nothing".
/// Empty if it is one. Reading a pipe would block, and a device may have no end.
[[nodiscard]] std::string describe_non_regular(const std::filesystem::path& path);

/// Why no file can be written under this name: an entry other than a regular file has it, which a new file
/// would replace. Empty if the name can be used.
[[nodiscard]] std::string describe_blocking_entry(const std::filesystem::path& path);

}  // namespace eti
