// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/doctor/finding.hpp"

namespace eti::doctor {

/// Checks EGL without a display. The driver runs in its own process, which it may crash. Nothing is linked: a
/// server's machine need not have EGL.
[[nodiscard]] Findings graphics();

/// Empty `renderer`: no rendering, because of `fault`.
[[nodiscard]] Finding diagnose_renderer(const std::string& renderer, const std::string& fault);

/// Where an OpenXR loader looks for the active runtime, in order (OpenXR 1.0 loader design, "Linux active
/// runtime location").
[[nodiscard]] std::vector<std::filesystem::path> openxr_runtime_paths();

[[nodiscard]] Findings openxr();
[[nodiscard]] Finding diagnose_openxr(bool loader, const std::vector<std::filesystem::path>& searched);

}  // namespace eti::doctor
