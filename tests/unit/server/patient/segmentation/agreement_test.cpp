// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/agreement.hpp"

#include <gtest/gtest.h>

namespace eti::segmentation {
namespace {

/// A grid of 6 x 6 x 6 voxels whose planes z = `first` to `last` are tongue.
imaging::Mask slab(int first, int last) {
    imaging::Mask mask;
    mask.geometry.size = {6, 6, 6};
    for (std::size_t i = 0; i < mask.geometry.count(); ++i) {
        const int z = mask.geometry.coordinates(i)[2];
        mask.value.push_back(z >= first && z <= last ? value_of(Label::tongue) : value_of(Label::outside));
    }
    return mask;
}

TEST(Agreement, SurfaceDistanceOfPlanesIsExact) {
    const Agreement same = agreement(slab(1, 1), slab(1, 1), {Label::tongue});
    EXPECT_EQ(same.dice, 1.0);
    EXPECT_EQ(same.mean_surface_distance, 0.0);
    const Agreement apart = agreement(slab(1, 1), slab(4, 4), {Label::tongue});
    EXPECT_EQ(apart.dice, 0.0);
    EXPECT_DOUBLE_EQ(apart.mean_surface_distance.value(), 3.0);
}

TEST(Agreement, MissingStructureHasNoSurfaceDistance) {
    for (const auto& [found, truth] :
         {std::pair(slab(9, 9), slab(1, 2)), std::pair(slab(1, 2), slab(9, 9))}) {
        const Agreement one = agreement(found, truth, {Label::tongue});
        EXPECT_EQ(one.dice, 0.0);
        EXPECT_EQ(one.mean_surface_distance, std::nullopt);
    }
    const Agreement none = agreement(slab(9, 9), slab(9, 9), {Label::tongue});
    EXPECT_EQ(none.dice, 1.0);
    EXPECT_EQ(none.mean_surface_distance, 0.0);
}

}  // namespace
}  // namespace eti::segmentation
