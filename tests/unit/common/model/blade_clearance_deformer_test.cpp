// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"
#include "common/model/tools/blade_camera.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti {
namespace {

class BladeClearanceDeformerTest : public testing::TestWithParam<Blade> {
  protected:
    Laryngoscope scope_ = make_laryngoscope(GetParam());
    BladeClearanceDeformer give_way_{.plate = plate_of(scope_), .lens = blade_camera_position(scope_)};

    /// Of a term newborn's size, in front of a tool whose frame is the patient's: its middle that far [m]
    /// from the blade, its gum 30 mm short of the blade's tip.
    [[nodiscard]] Landmarks mouth(float aside) const {
        Landmarks points = zero_landmarks();
        const Vec3f gum(aside, -8e-3f, scope_.blade_length - 30e-3f);
        points[static_cast<std::size_t>(Landmark::upper_gum)] = gum;
        points[static_cast<std::size_t>(Landmark::mouth_opening)] = gum + Vec3f(0.0f, 10e-3f, -6e-3f);
        points[static_cast<std::size_t>(Landmark::glottis)] = gum + Vec3f(0.0f, 52e-3f, 44e-3f);
        return points;
    }
    [[nodiscard]] PosedBladeClearanceDeformer in_a_mouth(float aside) const {
        return blade_clearance_for(scope_, RigidTransform{}, mouth(aside));
    }

    // Height of the contact face above a point of the axis.
    [[nodiscard]] float crown(float along) const { return give_way_.plate.height(along); }
};

TEST_P(BladeClearanceDeformerTest, FaceMatchesTheDrawnMesh) {
    // The highest vertices of each ring along the blade are the crown; columns lie a tenth of the width
    // apart, so that the nearest one to the middle is up to 1.2 mm / 400 lower.
    const TriangleMesh mesh = laryngoscope_mesh(scope_);
    std::size_t seen = 0;
    for (const Vec3f& v : mesh.vertices) {
        if (v.z() < BladeClearanceDeformer::heel + 1e-3f || v.y() > 8e-3f) {
            continue;
        }
        const float width = give_way_.plate.width(v.z());
        EXPECT_LE(std::fabs(v.x()), 0.5f * width + 1e-6f);
        EXPECT_LE(v.y(), crown(v.z()) + 1e-6f) << v.transpose();
        seen += v.y() > crown(v.z()) - 0.05e-3f ? 1 : 0;
    }
    EXPECT_GE(seen, 40u);
}

// Tissue that has entered the plate by no more than the stated depth leaves it completely: through the face,
// or over an edge.
TEST_P(BladeClearanceDeformerTest, NoTissueRemainsInThePlate) {
    constexpr float thickness = 1.5e-3f;  // of laryngoscope_mesh.cpp
    const BladePlate& plate = give_way_.plate;
    const float tip = scope_.blade_length;
    const auto face = [&](float x, float z) {
        const float share = x / (0.5f * plate.width(z));
        return plate.height(z) - plate.crown * plate.width(z) / plate.wide * share * share;
    };
    int from_face = 0, over_edge = 0;
    for (float z = BladeClearanceDeformer::heel + BladeClearanceDeformer::beside; z <= scope_.blade_length;
         z += 0.5e-3f) {
        const float half = plate.outline(z);
        const float over =
            BladeClearanceDeformer::edge * std::min(half / BladeClearanceDeformer::edge_begins, 1.0f);
        for (float x = -half; x <= half; x += 0.1e-3f) {
            for (float depth = -1e-3f; depth <= thickness; depth += 0.1e-3f) {
                const Vec3f now = give_way_(Vec3f(x, face(x, z) - depth, z));
                EXPECT_GE(now.z(), z);
                const bool beside = std::fabs(now.x()) > plate.outline(now.z()) || now.z() > tip;
                EXPECT_TRUE(beside ||
                            now.y() > face(now.x(), now.z()) + BladeClearanceDeformer::clearance - 1e-6f)
                    << x << ' ' << depth << ' ' << z;
                from_face += beside ? 0 : 1;
            }
            // Of the flange, which lies deeper than the face can clear.
            if (x > half - over + 0.05e-3f && z < 0.6f * scope_.blade_length) {
                const Vec3f now =
                    give_way_(Vec3f(x, face(x, z) - BladeClearanceDeformer::deepest - thickness, z));
                EXPECT_GT(now.x(), half) << x << ' ' << z;
                ++over_edge;
            }
        }
    }
    EXPECT_GT(from_face, 10000);
    EXPECT_GT(over_edge, 500);
}

TEST_P(BladeClearanceDeformerTest, MidlinePointsLeaveAlongTheHeight) {
    for (float z = BladeClearanceDeformer::heel + BladeClearanceDeformer::beside; z <= scope_.blade_length;
         z += 1e-3f) {
        for (float depth = -3e-3f;
             depth <= BladeClearanceDeformer::deepest - BladeClearanceDeformer::clearance; depth += 0.1e-3f) {
            const Vec3f point(0.0f, crown(z) - depth, z);
            const Vec3f now = give_way_(point);
            if (now.z() <= scope_.blade_length) {
                EXPECT_GE(now.y(), crown(now.z()) + BladeClearanceDeformer::clearance - 1e-6f)
                    << point.transpose();
            }
            EXPECT_NEAR(now.x(), 0.0f, 1e-9f);
        }
    }
}

// A wall that the tip runs into, or a fold across it: too deep for the face, it would remain in the plate.
TEST_P(BladeClearanceDeformerTest, TissueAcrossTheTipMovesPastIt) {
    const float tip = scope_.blade_length;
    for (float z = tip - BladeClearanceDeformer::tip; z <= tip; z += 0.1e-3f) {
        for (float x = -2e-3f; x <= 2e-3f; x += 0.5e-3f) {
            const float highest = crown(z) - 0.3e-3f;  // below the face, whose edges are lower
            for (float y = highest - BladeClearanceDeformer::tip_until + 0.5e-3f;
                 y < highest - BladeClearanceDeformer::deepest; y += 0.1e-3f) {
                EXPECT_GT(give_way_(Vec3f(x, y, z)).z(), tip) << x << ' ' << y << ' ' << z;
            }
            const Vec3f on_the_face(
                x, crown(z) + BladeClearanceDeformer::clearance - BladeClearanceDeformer::tip_from, z);
            EXPECT_EQ(give_way_(on_the_face).z(), z) << x;
        }
    }
}

// A blade at the corner of a mouth: all of it between the lips then lies beside the plate.
TEST_P(BladeClearanceDeformerTest, MouthCornerMovesBesideThePlate) {
    for (const float side : {-1.0f, 1.0f}) {
        const PosedBladeClearanceDeformer placed = in_a_mouth(side * 9e-3f);
        const BladeClearanceDeformer& parts = placed.give_way;
        ASSERT_GT(parts.aside, 2e-3f);
        ASSERT_LT(parts.aside, BladeClearanceDeformer::max_corner_shift);
        EXPECT_EQ(parts.side, -side);
        const float z = parts.lips_end - 5e-3f;
        const float half = 0.5f * parts.plate.width(z);
        for (float y = crown(z) - BladeClearanceDeformer::under; y <= crown(z); y += 0.25e-3f) {
            for (float out = parts.corner; out < half + 3e-3f; out += 0.1e-3f) {
                const Vec3f now = parts(Vec3f(parts.side * out, y, z));
                EXPECT_GT(parts.side * now.x(), half) << out << ' ' << y;
                EXPECT_EQ(now.y(), y);
            }
        }
    }
    EXPECT_EQ(in_a_mouth(0.0f).give_way.aside, 0.0f) << "in the middle no corner is in its way";
    EXPECT_EQ(in_a_mouth(0.2f).give_way.aside, 0.0f) << "nor far off";
}

// Tissue beneath the larger blade's capsule, which keeps particles away: its radius is 3.5 mm.
TEST_P(BladeClearanceDeformerTest, LensIsClearOfTissue) {
    const Vec3f lens = blade_camera_position(scope_);
    for (float y = -3.5e-3f; y > lens.y() - 3e-3f; y -= 0.1e-3f) {
        const Vec3f now = give_way_(Vec3f(0.0f, y, lens.z()));
        EXPECT_LT(now.y(), lens.y() - 0.2e-3f) << y;
    }
}

TEST_P(BladeClearanceDeformerTest, AffectedRegionCoversDisplacements) {
    Random random(5);
    for (const BladeClearanceDeformer& give_way : {give_way_, in_a_mouth(9e-3f).give_way}) {
        int moved = 0, left = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3f centre(0.15f * (random.uniform() - 0.5f), 0.08f * (random.uniform() - 0.5f),
                               (scope_.blade_length + 0.06f) * random.uniform() - 0.03f);
            const Vec3f place = centre + 2e-3f * Vec3f(random.uniform(), random.uniform(), random.uniform());
            const bool moves = give_way.moves(centre, 4e-3f);
            left += moves ? 0 : 1;
            const float way = (give_way(place) - place).norm();
            EXPECT_LE(way, give_way.reach(place, 0.0f));
            if (way > 0.0f) {
                ++moved;
                EXPECT_TRUE(moves) << place.transpose();
            }
        }
        EXPECT_GT(moved, 100);
        EXPECT_GT(left, 5000);
    }
    // A displacement outside the bound would be missed: it starts without a step there.
    const BladeClearanceDeformer give_way = in_a_mouth(9e-3f).give_way;
    for (int i = 0; i < 200000; ++i) {
        const Vec3f place(0.10f * (random.uniform() - 0.5f), 0.05f * (random.uniform() - 0.5f),
                          (scope_.blade_length + 0.02f) * random.uniform());
        if (give_way.where().contains(place) &&
            !Eigen::AlignedBox3f(give_way.where().min() + Vec3f::Constant(0.05e-3f),
                                 give_way.where().max() - Vec3f::Constant(0.05e-3f))
                 .contains(place)) {
            EXPECT_LT((give_way(place) - place).norm(), 0.1e-3f) << place.transpose();
        }
    }
}

TEST_P(BladeClearanceDeformerTest, FarAndRearPointsAreUnmoved) {
    const float z = 0.6f * scope_.blade_length;
    const float face = crown(z);
    const float half = 0.5f * give_way_.plate.width(z);
    // Where steepest (d - deepest - easing / 2) equals d, and the contribution of easing.
    constexpr float deep = BladeClearanceDeformer::steepest *
                               (BladeClearanceDeformer::deepest + 0.5f * BladeClearanceDeformer::easing) /
                               (BladeClearanceDeformer::steepest - 1.0f) +
                           BladeClearanceDeformer::easing;
    const float far = half + BladeClearanceDeformer::gathers * BladeClearanceDeformer::edge_aside;
    for (const Vec3f& point :
         {Vec3f(0, face + BladeClearanceDeformer::clearance + BladeClearanceDeformer::softness, z),
          Vec3f(0, face - deep, z), Vec3f(0, -0.01f, z), Vec3f(far, face, z), Vec3f(-far, face, z),
          Vec3f(0, face, BladeClearanceDeformer::heel),
          Vec3f(0, face,
                scope_.blade_length + BladeClearanceDeformer::gathers * BladeClearanceDeformer::tip_past)}) {
        EXPECT_LT((give_way_(point) - point).norm(), 1e-7f) << point.transpose();
    }
}

TEST_P(BladeClearanceDeformerTest, PreservesOrientationWithBoundedStretch) {
    // No surface is inverted, and no edge, in any direction, becomes longer than the header states. Round-off
    // of 4e-9 m at positions of a decimetre is two ten-thousandths of the step.
    constexpr float apart = 0.02e-3f;
    const auto slopes = [apart](const BladeClearanceDeformer& give_way, const Vec3f& point) {
        Mat3f of;
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3f step = apart * Vec3f::Unit(axis);
            of.col(axis) = (give_way(point + 0.5f * step) - give_way(point - 0.5f * step)) / apart;
        }
        return of;
    };
    Random random(7);
    int at_corners = 0;
    for (const BladeClearanceDeformer& give_way :
         {give_way_, in_a_mouth(9e-3f).give_way, in_a_mouth(-11e-3f).give_way}) {
        for (int i = 0; i < 100000; ++i) {
            const Vec3f point(0.030f * (random.uniform() - 0.5f), 0.024f * (random.uniform() - 0.5f),
                              (scope_.blade_length + 0.01f) * random.uniform());
            const Mat3f here = slopes(give_way, point);
            // Where all depths map onto the face the determinant is zero, and where a curve has a corner
            // within the step the mean of both sides may be below it. A fold is wider than a corner.
            if (here.determinant() < -1e-3f) {
                ++at_corners;
                const Vec3f aside = Vec3f::Constant(2.0f * apart);
                EXPECT_TRUE(slopes(give_way, point + aside).determinant() > -1e-3f ||
                            slopes(give_way, point - aside).determinant() > -1e-3f)
                    << here.determinant() << " at " << point.transpose();
            }
            // The largest singular value.
            const float longest =
                std::sqrt(Eigen::SelfAdjointEigenSolver<Mat3f>(here.transpose() * here).eigenvalues()[2]);
            EXPECT_LT(longest, BladeClearanceDeformer::max_stretch + 1e-2f) << point.transpose();
        }
    }
    EXPECT_LT(at_corners, 100);  // out of 300 thousand
}

TEST_P(BladeClearanceDeformerTest, IsEquivariantUnderToolPose) {
    Random random(9);
    const RigidTransform tool{quaternion_from(Vec3f(0.7f, -0.4f, 1.1f)), Vec3f(0.02f, -0.05f, 0.04f)};
    const PosedBladeClearanceDeformer here = in_a_mouth(9e-3f);
    Landmarks there = mouth(9e-3f);
    for (Vec3f& point : there) {
        point = tool * point;
    }
    const PosedBladeClearanceDeformer placed = blade_clearance_for(scope_, tool, there);
    for (int i = 0; i < 100; ++i) {
        const Vec3f point(0.008f * (random.uniform() - 0.5f), 5e-3f * random.uniform(),
                          0.08f * random.uniform());
        EXPECT_LT((placed(tool * point) - tool * here(point)).norm(), 2e-7f);
    }
}

INSTANTIATE_TEST_SUITE_P(Blades, BladeClearanceDeformerTest,
                         testing::Values(Blade::miller_0, Blade::miller_1),
                         [](const auto& blade) { return std::string(name_of(blade.param)); });

}  // namespace
}  // namespace eti
