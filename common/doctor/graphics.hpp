// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/doctor/finding.hpp"

namespace eti::doctor {

/// What EGL gives without a display. The driver runs in a process of its own, which it may crash. Nothing
/// here is linked: a server's machine need not have it.
[[nodiscard]] Findings graphics();

/// Empty `renderer`: nothing draws, because of `fault`.
[[nodiscard]] Finding judge_renderer(const std::string& renderer, const std::string& fault);

/// Where an OpenXR loader looks for the active runtime, in order (OpenXR 1.0 loader design, "Linux active
/// runtime location").
[[nodiscard]] std::vector<std::filesystem::path> openxr_runtime_paths();

[[nodiscard]] Findings openxr();
[[nodiscard]] Finding judge_openxr(bool loader, const std::vector<std::filesystem::path>& searched);

}  // namespace eti::doctor
