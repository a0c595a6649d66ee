// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"
#include "common/model/give_way.hpp"

namespace eti {
namespace {

class GiveWayTest : public testing::TestWithParam<Blade> {
  protected:
    Laryngoscope scope_ = make_laryngoscope(GetParam());
    GiveWay give_way_{plate_of(scope_)};

    // Of the contact face, above a place of the axis.
    [[nodiscard]] float crown(float along) const { return give_way_.plate.height(along); }
};

TEST_P(GiveWayTest, TheFaceIsThatOfTheMeshDrawn) {
    // The highest vertices of each ring along the blade are the crown; columns lie a tenth of the width
    // apart, so that the nearest one to the middle is up to 1.2 mm / 400 lower.
    const TriangleMesh mesh = laryngoscope_mesh(scope_);
    std::size_t seen = 0;
    for (const Vec3f& v : mesh.vertices) {
        if (v.z() < GiveWay::heel + 1e-3f || v.y() > 8e-3f) {
            continue;
        }
        const float width = give_way_.plate.width(v.z());
        EXPECT_LE(std::fabs(v.x()), 0.5f * width + 1e-6f);
        EXPECT_LE(v.y(), crown(v.z()) + 1e-6f) << v.transpose();
        seen += v.y() > crown(v.z()) - 0.05e-3f ? 1 : 0;
    }
    EXPECT_GE(seen, 40u);
}

TEST_P(GiveWayTest, NothingIsLeftBeforeTheFace) {
    for (float z = GiveWay::heel + GiveWay::beside; z <= scope_.blade_length; z += 1e-3f) {
        const float half = 0.5f * give_way_.plate.width(z);
        for (float share = -1.0f; share <= 1.0f; share += 0.125f) {
            for (float depth = -3e-3f; depth <= GiveWay::deepest - GiveWay::clearance; depth += 0.1e-3f) {
                const Vec3f point(share * half, crown(z) - depth, z);
                const float face =
                    crown(z) - give_way_.plate.crown * 2.0f * half / give_way_.plate.wide * share * share;
                const Vec3f now = give_way_(point);
                if (face - point.y() <= GiveWay::deepest - GiveWay::clearance) {
                    EXPECT_GE(now.y(), face + GiveWay::clearance - 1e-6f) << point.transpose();
                }
                EXPECT_EQ(now.x(), point.x());
                EXPECT_EQ(now.z(), point.z());
            }
        }
    }
}

TEST_P(GiveWayTest, KnowsWhereItMovesAnything) {
    Random random(5);
    int moved = 0, left = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f centre(0.05f * (random.uniform() - 0.5f), 0.05f * (random.uniform() - 0.5f),
                           (scope_.blade_length + 0.04f) * random.uniform() - 0.02f);
        const Vec3f place = centre + 2e-3f * Vec3f(random.uniform(), random.uniform(), random.uniform());
        const bool moves = give_way_.moves(centre, 4e-3f);
        left += moves ? 0 : 1;
        if (give_way_(place) != place) {
            ++moved;
            EXPECT_TRUE(moves) << place.transpose();
        }
    }
    EXPECT_GT(moved, 200);
    EXPECT_GT(left, 5000);
}

TEST_P(GiveWayTest, WhatIsFarOrBehindThePlateStays) {
    const float z = 0.6f * scope_.blade_length;
    const float face = crown(z);
    const float half = 0.5f * give_way_.plate.width(z);
    constexpr float deep = GiveWay::deepest + GiveWay::release;
    for (const Vec3f& point :
         {Vec3f(0, face + GiveWay::clearance + GiveWay::softness, z), Vec3f(0, face - deep, z),
          Vec3f(0, -0.01f, z), Vec3f(half + GiveWay::beside, face, z),
          Vec3f(-half - GiveWay::beside, face, z), Vec3f(0, face, GiveWay::heel),
          Vec3f(0, face, scope_.blade_length + GiveWay::beside)}) {
        EXPECT_LT((give_way_(point) - point).norm(), 1e-7f) << point.transpose();
    }
}

TEST_P(GiveWayTest, NeighboursStayNeighboursInTheirOrder) {
    // What lies farther out stays farther out, so that no surface is turned inside out; and no edge, however
    // it lies, becomes longer than the header derives. Round-off of 2e-9 m in places of a decimetre is a
    // ten-thousandth of the step.
    constexpr float apart = 0.02e-3f;
    Random random(7);
    for (int i = 0; i < 200000; ++i) {
        const Vec3f point(0.020f * (random.uniform() - 0.5f), 0.020f * (random.uniform() - 0.5f),
                          (scope_.blade_length + 0.01f) * random.uniform());
        Vec3f way(random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() - 0.5f);
        way = apart * (way.norm() > 1e-3f ? way.normalized() : Vec3f(Vec3f::UnitY()));
        EXPECT_LT((give_way_(point + way) - give_way_(point)).norm(), (GiveWay::most_stretch + 1e-3f) * apart)
            << point.transpose();
        const Vec3f up = give_way_(point + apart * Vec3f::UnitY()) - give_way_(point);
        EXPECT_GT(up.y(), -1e-8f) << point.transpose();
        EXPECT_LE((give_way_(point) - point).norm(), GiveWay::most);
    }
}

TEST_P(GiveWayTest, GoesWithTheTool) {
    Random random(9);
    const RigidTransform tool{quaternion_from(Vec3f(0.7f, -0.4f, 1.1f)), Vec3f(0.02f, -0.05f, 0.04f)};
    for (int i = 0; i < 100; ++i) {
        const Vec3f point(0.008f * (random.uniform() - 0.5f), 5e-3f * random.uniform(),
                          0.08f * random.uniform());
        EXPECT_LT((give_way_(tool * point, tool) - tool * give_way_(point)).norm(), 1e-7f);
    }
}

INSTANTIATE_TEST_SUITE_P(Blades, GiveWayTest, testing::Values(Blade::miller_0, Blade::miller_1),
                         [](const auto& blade) { return std::string(name_of(blade.param)); });

}  // namespace
}  // namespace eti
