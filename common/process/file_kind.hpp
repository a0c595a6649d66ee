// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

namespace eti {

/// What a path leads to where that is no plain file, in words: "a folder", "a pipe", "a device", "a socket"
/// or "nothing". Empty where it is one. A pipe would keep its reader waiting, and a device may never end.
[[nodiscard]] std::string no_plain_file(const std::filesystem::path& path);

/// Why no file can be written under this name: something else than a plain file has it, which a new file
/// would replace. Empty where nothing is in the way.
[[nodiscard]] std::string in_the_way(const std::filesystem::path& path);

}  // namespace eti
