// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/review/score.hpp"
#include "client/review/summary.hpp"

namespace eti::review {

/// Maximum number of samples per session on a page: sampled at 30 Hz, more coarsely in longer sessions.
inline constexpr std::size_t max_samples = 3600;

/// All data of a session on the page except its anatomy: outcome, metrics with their traffic lights, time
/// line samples, events, key moments and advice. NaN becomes null. Lengths in the units that the `label`s
/// name. Throws hdf5::Error.
[[nodiscard]] nlohmann::ordered_json session_json(const session::SessionReader& reader,
                                                  const Summary& summary);

/// Surfaces, weights and frames for the page's 3-D view, as base64 of little-endian arrays: see
/// docs/report.md. Throws hdf5::Error.
[[nodiscard]] nlohmann::ordered_json anatomy_json(const session::SessionReader& reader);

/// Label, unit, target and source of each metric, common to all sessions.
[[nodiscard]] nlohmann::ordered_json fields_json();

/// JSON that is safe inside an HTML `script` element: `<` is escaped and invalid UTF-8 replaced.
[[nodiscard]] std::string escape_for_script(const nlohmann::ordered_json& json);

/// The page template bundled into this program; empty if npm was missing in the build.
[[nodiscard]] std::string_view report_page();

/// Writes DIR/report.html about these sessions, comparing the first with the others, scored by `model` if
/// given. Creates the folder, never overwrites a file. Returns the page's path; empty if `stop` returned
/// true. Throws ExportError, hdf5::Error.
std::filesystem::path write_report(const std::vector<std::filesystem::path>& sessions,
                                   const std::filesystem::path& folder,
                                   const std::optional<ScoreModel>& model, const std::function<bool()>& stop);

}  // namespace eti::review
