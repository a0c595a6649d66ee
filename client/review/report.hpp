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

/// What a page shows of sessions at most: 30 Hz, and no more samples than this in longer sessions.
inline constexpr std::size_t most_samples = 3600;

/// Everything that the page shows of a session but its anatomy: outcome, parameters with their lights,
/// samples of the time line, events, key moments and what to practise. NaN becomes null. Lengths in the
/// units that `label`s name. Throws hdf5::Error.
[[nodiscard]] nlohmann::ordered_json session_json(const session::SessionReader& reader,
                                                  const Summary& summary);

/// Surfaces, weights and frames for the page's 3-D view, as base64 of little-endian arrays: see
/// docs/report.md. Throws hdf5::Error.
[[nodiscard]] nlohmann::ordered_json anatomy_json(const session::SessionReader& reader);

/// What every session's parameters have in common: label, unit, aim and source.
[[nodiscard]] nlohmann::ordered_json fields_json();

/// JSON that can stand inside an HTML `script` element: `<` and invalid UTF-8 never get through.
[[nodiscard]] std::string embeddable(const nlohmann::ordered_json& json);

/// The page with a place for sessions, as it was bundled into this program; empty when npm was not there.
[[nodiscard]] std::string_view report_page();

/// Writes DIR/report.html about these sessions, the first compared with the others, scored by `model` where
/// there is one. Makes the folder, replaces no file. Returns the page's path; empty when `stop` said so.
/// Throws ExportError, hdf5::Error.
std::filesystem::path write_report(const std::vector<std::filesystem::path>& sessions,
                                   const std::filesystem::path& folder,
                                   const std::optional<ScoreModel>& model, const std::function<bool()>& stop);

}  // namespace eti::review
