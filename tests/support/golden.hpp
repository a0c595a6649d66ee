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

/// The picture kept as `folder`/`name`.png. ETI_RENEW_GOLDEN=1 in the environment keeps `drawn` from now on,
/// to be looked at. Throws std::runtime_error where there is none.
[[nodiscard]] inline render::Image golden(const std::filesystem::path& folder, const std::string& name,
                                          const render::Image& drawn) {
    const std::filesystem::path file = folder / (name + ".png");
    if (std::getenv("ETI_RENEW_GOLDEN") != nullptr) {
        std::filesystem::create_directories(folder);
        render::write_png(drawn, file);
    }
    return render::read_png(file);
}

/// Whether two pixels differ by more than what drivers do at the edges of letters and shapes: 24 levels.
[[nodiscard]] inline bool apart(const std::uint8_t* a, const std::uint8_t* b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])}) > 24;
}

/// Writes a picture that is not the golden one where it can be looked at, and says what to do.
[[nodiscard]] inline std::string kept_for_a_look(const render::Image& drawn, const std::string& name) {
    const auto file = std::filesystem::temp_directory_path() / ("eti-golden-" + name + ".png");
    render::write_png(drawn, file);
    return "see " + file.string() + "; if it is as it should be, run this with ETI_RENEW_GOLDEN=1";
}

}  // namespace eti::test
