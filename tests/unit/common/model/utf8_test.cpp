// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/utf8.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

TEST(Utf8, ATextIsCutBetweenCharacters) {
    constexpr std::string_view text = "a\u00b5\u2192\U0001f476z";  // 1, 2, 3, 4 and 1 bytes
    const std::size_t expected[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11, 11};
    for (std::size_t most = 0; most < std::size(expected); ++most) {
        EXPECT_EQ(utf8_prefix_length(text, most), expected[most]) << most;
    }
    EXPECT_EQ(utf8_prefix_length("", 3), 0u);
}

}  // namespace
}  // namespace eti
