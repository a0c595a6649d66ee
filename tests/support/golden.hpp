// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "client/render/image.hpp"

namespace eti::test {

/// The golden image `folder`/`name`.png. ETI_RENEW_GOLDEN=1 in the environment replaces it with `drawn`, to
/// be reviewed. Throws std::runtime_error when it does not exist.
[[nodiscard]] inline render::Image golden(const std::filesystem::path& folder, const std::string& name,
                                          const render::Image& drawn) {
    const std::filesystem::path file = folder / (name + ".png");
    if (std::getenv("ETI_RENEW_GOLDEN") != nullptr) {
        std::filesystem::create_directories(folder);
        render::write_png(drawn, file);
    }
    return render::read_png(file);
}

/// Whether two pixels differ by more than drivers do at the edges of letters and shapes: 24 levels.
[[nodiscard]] inline bool pixels_differ(const std::uint8_t* a, const std::uint8_t* b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])}) > 24;
}

/// Saves an image that differs from the golden one for inspection; returns a message that says what to do.
[[nodiscard]] inline std::string save_for_inspection(const render::Image& drawn, const std::string& name) {
    const auto file = std::filesystem::temp_directory_path() / ("eti-golden-" + name + ".png");
    render::write_png(drawn, file);
    return "see " + file.string() + "; if it is as it should be, run this with ETI_RENEW_GOLDEN=1";
}

}  // namespace eti::test
