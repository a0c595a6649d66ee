// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/math/random.hpp"

namespace eti::imaging {
namespace {

constexpr Size size = {17, 13, 11};

std::size_t at(int x, int y, int z) {
    return static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
}

template <class Visit>
void for_each(const Visit& visit) {
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                visit(x, y, z);
            }
        }
    }
}

Bits empty() {
    return Bits(at(size[0] - 1, size[1] - 1, size[2] - 1) + 1, 0);
}

TEST(Filter, DistanceMatchesNearestSetVoxel) {
    Random random(4);
    Bits mask = empty();
    std::vector<std::array<int, 3>> set;
    for (int i = 0; i < 12; ++i) {
        const std::array<int, 3> p = {static_cast<int>(random.bits() % 17),
                                      static_cast<int>(random.bits() % 13),
                                      static_cast<int>(random.bits() % 11)};
        set.push_back(p);
        mask[at(p[0], p[1], p[2])] = 1;
    }
    const std::vector<float> found = distance_to(size, mask);
    for_each([&](int x, int y, int z) {
        float expected = 1e9f;
        for (const auto& p : set) {
            expected =
                std::min(expected, std::hypot(static_cast<float>(x - p[0]), static_cast<float>(y - p[1]),
                                              static_cast<float>(z - p[2])));
        }
        ASSERT_NEAR(found[at(x, y, z)], expected, 1e-5f * (1.0f + expected));
    });
    EXPECT_GT(distance_to(size, empty())[0], 1e9f);
}

TEST(Filter, ClosingFillsGapsNarrowerThanBall) {
    // A block with a slot one voxel wide and a channel five voxels wide.
    Bits mask = empty();
    for_each([&](int x, int y, int z) {
        const bool slot = x == 4 && y > 3;
        const bool channel = x >= 8 && x <= 12 && y > 3;
        mask[at(x, y, z)] = y < 10 && !slot && !channel ? 1 : 0;
    });
    const Bits closed = morphological_close(size, mask, 1.5f);
    EXPECT_EQ(closed[at(4, 6, 5)], 1);
    EXPECT_EQ(closed[at(10, 6, 5)], 0);
    // Nothing grows beyond the block, not even at the volume's faces.
    for_each([&](int x, int y, int z) {
        if (y >= 10) {
            ASSERT_EQ(closed[at(x, y, z)], 0) << x << " " << y << " " << z;
        }
    });
}

TEST(Filter, MaskedSmoothingIgnoresOutside) {
    Bits mask = empty();
    std::vector<float> value(mask.size(), -1000.0f);
    for_each([&](int x, int y, int z) {
        if (x < 8) {
            mask[at(x, y, z)] = 1;
            value[at(x, y, z)] = 50.0f;
        }
    });
    const std::vector<float> mean = smooth_within(size, value, mask, 2.0f);
    EXPECT_NEAR(mean[at(7, 6, 5)], 50.0f, 1e-3f);
    EXPECT_NEAR(mean[at(8, 6, 5)], 50.0f, 1e-3f);  // beside the mask
}

TEST(Filter, WatershedSplitsAtNeck) {
    // Two balls of radius 4 that overlap in a neck.
    Bits mask = empty();
    for_each([&](int x, int y, int z) {
        const float a =
            std::hypot(static_cast<float>(x - 4), static_cast<float>(y - 6), static_cast<float>(z - 5));
        const float b =
            std::hypot(static_cast<float>(x - 11), static_cast<float>(y - 6), static_cast<float>(z - 5));
        mask[at(x, y, z)] = std::min(a, b) <= 4.0f ? 1 : 0;
    });
    Bits rest = mask;
    for (auto& v : rest) {
        v = 1 - v;
    }
    const std::vector<float> depth = distance_to(size, rest);
    Bits markers = empty();
    markers[at(1, 6, 5)] = 1;  // not at the balls' centres
    markers[at(14, 6, 5)] = 2;
    const Watershed parts = watershed(size, mask, depth, markers);
    for_each([&](int x, int y, int z) {
        if (mask[at(x, y, z)] != 0 && x != 7 && x != 8) {
            ASSERT_EQ(parts.owner[at(x, y, z)], x < 8 ? 1 : 2) << x << " " << y << " " << z;
        }
    });
    EXPECT_GT(parts.neck, 1.0f);
    EXPECT_LT(parts.neck, 4.0f);
}

}  // namespace
}  // namespace eti::imaging
