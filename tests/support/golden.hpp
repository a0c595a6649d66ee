// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "client/render/image.hpp"

namespace eti::test {

/// Share of the pixels of two pictures of one size that differ by more than 24 levels, which is more than
/// drivers differ by within shapes.
[[nodiscard]] inline double share_apart(const render::Image& a, const render::Image& b) {
    std::size_t apart = 0;
    for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
        int most = 0;
        for (std::size_t c = i; c < i + 3; ++c) {
            most = std::max(most, std::abs(a.rgba[c] - b.rgba[c]));
        }
        apart += most > 24 ? 1 : 0;
    }
    return 4.0 * static_cast<double>(apart) / static_cast<double>(a.rgba.size());
}

/// Whether at most the share `most` of the pixels differs from the golden picture in `file`. If not, saves
/// the picture for inspection.
[[nodiscard]] inline ::testing::AssertionResult matches_golden(const render::Image& drawn,
                                                               const std::filesystem::path& file,
                                                               double most) {
    const render::Image kept = render::read_png(file);
    const bool same_size = kept.width == drawn.width && kept.height == drawn.height;
    const double apart = same_size ? share_apart(drawn, kept) : 1.0;
    if (apart <= most) {
        return ::testing::AssertionSuccess();
    }
    const auto saved = std::filesystem::temp_directory_path() / file.filename();
    render::write_png(drawn, saved);
    return ::testing::AssertionFailure() << 100.0 * apart << " % of the pixels differ; inspect " << saved
                                         << " and, if it is as it should be, copy it to " << file;
}

}  // namespace eti::test
