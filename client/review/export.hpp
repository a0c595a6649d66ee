// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "client/review/output.hpp"

namespace eti::review {

/// Writes every series of a session as CSV (RFC 4180; decimal point; header with units; time in seconds):
/// inputs, commands, tools, tube_nodes, skeleton, metrics, deformation, events, summary, ratings, answers.
/// Creates the folder, never overwrites a file. `progress` is called with each file; when `stop` returns
/// true, the file being written is removed and the export ends. Returns the files written. Throws
/// ExportError, hdf5::Error, or as make_folder() does.
std::vector<std::filesystem::path> export_csv(
    const std::filesystem::path& session, const std::filesystem::path& folder,
    const std::function<void(const std::filesystem::path&)>& progress, const std::function<bool()>& stop);

}  // namespace eti::review
