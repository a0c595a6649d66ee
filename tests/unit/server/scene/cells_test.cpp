// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "server/patient/model/cells_of.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::patient {
namespace {

TEST(Cells, WholeCellsJoinFiveTetrahedra) {
    const Patient& patient = test::coarse_newborn();
    const std::vector<std::uint32_t> tongue = tetrahedra_of(Tissue::tongue, patient);
    const Cells cells = cells_of(tongue, patient);
    EXPECT_EQ(5 * cells.hexahedra.size() + cells.tetrahedra.size(), tongue.size());
    EXPECT_GT(cells.hexahedra.size(), cells.tetrahedra.size() / 5);
}

// Corner numbers have one bit per axis: in the lattice all edges along an axis are equal.
TEST(Cells, CornerBitsAreAxes) {
    const Patient& patient = test::coarse_newborn();
    const Cells cells = cells_of(tetrahedra_of(Tissue::tongue, patient), patient);
    ASSERT_FALSE(cells.hexahedra.empty());
    for (const auto& corner : cells.hexahedra) {
        const auto at = [&](unsigned v) -> const Vec3f& { return patient.particles.rest[corner[v]]; };
        const float spacing = 2.0f * patient.particles.radius[corner[0]];
        for (unsigned axis = 0; axis < 3; ++axis) {
            const Vec3f first = at(1u << axis) - at(0);
            EXPECT_NEAR(first.norm(), spacing, 1e-3f * spacing);
            for (unsigned v = 0; v < 8; ++v) {
                if ((v >> axis & 1u) == 0) {
                    EXPECT_LT((at(v | 1u << axis) - at(v) - first).norm(), 1e-3f * spacing);
                }
            }
        }
    }
}

}  // namespace
}  // namespace eti::patient
