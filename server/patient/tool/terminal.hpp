// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/patient/segmentation/labels.hpp"

// Shared by the commands of eti-anatomy: output for people and programs, and cancellation.
namespace eti::tool {

using namespace segmentation;

/// Result of a command, for people and for programs.
struct Result {
    std::string text;
    nlohmann::ordered_json json;
    int status = 0;  ///< exit status of the program
};

inline constexpr int status_refused = 1;
inline constexpr int status_no_model = 3;   ///< surfaces were written, but the rest is not sufficient for a
                                            ///< model
inline constexpr int status_doubtful = 4;   ///< labels were written, but with contradictions
inline constexpr int status_uncertain = 5;  ///< labels were written, and deserve little confidence
inline constexpr int status_interrupted = 130;

/// Draws a progress bar on a terminal, at most ten times a second; thread-safe. Returns false to cancel.
[[nodiscard]] bool draw_progress(float share, std::string_view what);
inline const Progress progress = draw_progress;
void clear_progress();

/// Prints a remark for the user to standard error.
void remark(std::string_view text);

/// The file's name without its volume extension, for naming related files.
[[nodiscard]] std::filesystem::path stem_of(const std::filesystem::path& file);

}  // namespace eti::tool
