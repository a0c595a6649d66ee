// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/posed_shell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::scene {
namespace {

// The last grid of the process is kept: it must not be taken for that of another posture.
TEST(PosedShell, GridIsThatOfItsOwnPosture) {
    const patient::Patient& newborn = test::coarse_newborn();
    const auto with_jaw_at = [&](float degrees) {
        patient::Posture posture;
        posture.jaw_opening = degrees * degree;
        return PosedShell(newborn, patient::pose_bones(newborn.skeleton, posture));
    };
    const PosedShell open = with_jaw_at(25.0f), open_again = with_jaw_at(25.0f),
                     nearly_closed = with_jaw_at(5.0f);
    EXPECT_EQ(open_again.distance().value, open.distance().value);
    EXPECT_NE(nearly_closed.distance().value, open.distance().value);
    // A shell's own vertices lie on it, within the error of interpolation in a grid of this spacing.
    for (const PosedShell* const shell : {&open, &nearly_closed, &open_again}) {
        float largest = 0.0f;
        for (const Vec3f& vertex : shell->vertices()) {
            largest = std::max(largest, std::abs(shell->distance().distance(vertex)));
        }
        EXPECT_LT(largest, newborn.shell.distance.spacing);
    }
}

}  // namespace
}  // namespace eti::scene
