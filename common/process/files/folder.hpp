// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string_view>

namespace eti {

/// Creates a folder that a user requested, with its parents. Throws std::runtime_error on failure, naming
/// `option`, which selects another folder.
void make_folder(const std::filesystem::path& folder, std::string_view option = "--out");

}  // namespace eti
