// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/components.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

TEST(Components, MeetAtFacesOnly) {
    constexpr std::array<int, 3> size{6, 5, 4};
    const auto at = [&](int x, int y, int z) {
        return static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
    };
    std::vector<std::uint8_t> mask(at(0, 0, size[2]), 0);
    mask[at(1, 1, 1)] = mask[at(2, 1, 1)] = 1;
    mask[at(3, 2, 1)] = 1;  // touches the first along an edge
    const Components found = components(size, mask);
    ASSERT_EQ(found.voxels.size(), 3u);
    EXPECT_EQ(found.voxels[found.largest()], 2u);
    EXPECT_NE(found.part[at(2, 1, 1)], found.part[at(3, 2, 1)]);
}

}  // namespace
}  // namespace eti
