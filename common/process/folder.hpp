// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string_view>

namespace eti {

/// Makes a folder that a user asked for, with those above it. Throws std::runtime_error where that is
/// refused; the message names `option`, by which another can be chosen.
void make_folder(const std::filesystem::path& folder, std::string_view option = "--out");

}  // namespace eti
