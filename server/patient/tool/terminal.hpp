// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/patient/segmentation/labels.hpp"

// What the commands of eti-anatomy share: how they talk to a person, to programs, and how they stop.
namespace eti::tool {

using namespace segmentation;

/// What a command found, for people and for programs.
struct Result {
    std::string text;
    nlohmann::ordered_json json;
    int status = 0;  ///< the program's exit status
};

inline constexpr int status_refused = 1;
inline constexpr int status_no_model = 3;  ///< surfaces were written, but what is left makes no model
inline constexpr int status_doubtful = 4;  ///< labels were written, but something in them cannot be true
inline constexpr int status_interrupted = 130;

/// Draws a bar on a terminal, at most ten times a second; several threads may call it. False asks to stop.
[[nodiscard]] bool draw_progress(float share, std::string_view what);
inline const Progress progress = draw_progress;
void clear_progress();

/// A remark for the person, on standard error.
void remark(std::string_view text);

/// The file's name without its volume format, for what lies beside it.
[[nodiscard]] std::filesystem::path stem_of(const std::filesystem::path& file);

}  // namespace eti::tool
