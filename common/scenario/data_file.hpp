// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace eti {

/// A mistake in a user's file: states file, line, key, what was found and what was expected.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A key as its reader describes it, for documents.
struct KeyDescription {
    std::string key;        ///< with its section: "physics.substeps"
    std::string values;     ///< "a whole number from 1 to 64"
    std::string otherwise;  ///< the default, as typed
    std::string help;
};

/// Names of a `kind` that find_data_file() finds, sorted.
[[nodiscard]] std::vector<std::string> data_names(const std::string& kind);

/// Resolves a scenario, operator or preset by name (a file `NAME.yaml` in the data folder's `kind` folder) or
/// by path. Throws InputError naming the searched folders and the available names.
[[nodiscard]] std::filesystem::path find_data_file(const std::string& name_or_path, const std::string& kind);

/// Reads a whole file of at most 1 MiB. Throws InputError.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

}  // namespace eti
