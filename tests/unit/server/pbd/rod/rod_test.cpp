// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "common/math/random.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti {
namespace {

constexpr float rod_dt = 1.0f / 720.0f;
const Vec3f rod_gravity(0.0f, -9.81f, 0.0f);

std::vector<Vec3f> nodes_of(const pbd::Rod& rod) {
    std::vector<Vec3f> nodes(rod.size() + 1);
    rod.nodes(nodes);
    return nodes;
}

float largest_gap(const pbd::Rod& rod) {
    float gap = 0.0f;
    for (std::size_t i = 0; i + 1 < rod.size(); ++i) {
        gap = std::max(gap, (rod.point(i, 1.0f) - rod.point(i + 1, 0.0f)).norm());
    }
    return gap;
}

float largest_distance(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    float distance = 0.0f;
    for (std::size_t i = 0; i < a.size(); ++i) {
        distance = std::max(distance, (a[i] - b[i]).norm());
    }
    return distance;
}

// Without loads the rod keeps its manufactured curve: an arc of radius R towards +y. A polygon of pieces h
// whose middles touch the arc deviates from it by h^2 / 8 R per piece.
TEST(Rod, KeepsItsRestCurve) {
    const Tube tube;
    const RigidTransform grip{Quatf::Identity(), Vec3f(0.01f, 0.02f, 0.03f)};
    pbd::Rod rod(tube, {}, grip);
    const std::vector<Vec3f> start = nodes_of(rod);
    const double h = 0.16 / static_cast<double>(rod.size());
    for (const Vec3f& node : start) {
        const double radius = std::hypot(double{node.y()} - 0.02 - 0.14, double{node.z()} - 0.03);
        EXPECT_NEAR(radius, 0.14, 1.2 * h * h / (8 * 0.14));
        EXPECT_FLOAT_EQ(node.x(), 0.01f);
    }
    EXPECT_GT(start.back().y(), 0.02f);
    EXPECT_GT(start.back().z(), 0.03f);
    test::run(rod, 1.0, rod_dt, Vec3f::Zero(), grip);
    EXPECT_LT(largest_distance(nodes_of(rod), start), 1e-7f);  // float32 of decimetres
}

// A free rod, bent and spinning: without external forces momentum is conserved. Linear momentum exactly,
// except for rounding; angular momentum to first order in dt of the pose update, so a tenth of the step must
// drift by about a tenth.
TEST(Rod, FreeRodKeepsItsMomentum) {
    const auto drift = [](float step, bool angular) {
        pbd::RodSettings settings;
        settings.held = false;
        settings.velocity_damping = 0.0f;
        Tube tube;
        pbd::Rod rod(tube, settings, {});
        const auto momentum = [&] {
            Vec3d linear = Vec3d::Zero();
            Vec3d spin = Vec3d::Zero();
            for (const pbd::RodSegment& s : rod.segments()) {
                linear += s.velocity / s.inverse_mass;
                spin +=
                    s.position.cross(s.velocity) / s.inverse_mass + s.angular_velocity / s.inverse_inertia;
            }
            return angular ? spin : linear;
        };
        // Two opposite pushes across and one along it.
        rod.predict(step, Vec3f::Zero(), {});
        rod.load(1, 0.6f, Vec3f(1e-4f, 3e-4f, 0.0f) / step);
        rod.load(rod.size() - 2, 0.85f, Vec3f(2e-4f, -3e-4f, 1e-4f) / step);
        rod.solve();
        rod.finish();
        const Vec3d before = momentum();
        test::run(rod, 0.1, step, Vec3f::Zero(), {});
        return (momentum() - before).norm() / before.norm();
    };
    EXPECT_LT(drift(rod_dt, false), 1e-10);
    EXPECT_LT(drift(0.1f * rod_dt, true), 0.2 * drift(rod_dt, true));
    EXPECT_LT(drift(rod_dt, true), 0.05);
}

// The same scene rotated and shifted gives the same motion. Both compute in double from float32 inputs:
// differences start at 6e-8 of the lengths and grow exponentially with the motion, by less than 100.
TEST(Rod, DoesNotDependOnTheFrame) {
    const RigidTransform turn{Quatf(Eigen::AngleAxisf(2.1f, Vec3f(0.48f, 0.6f, 0.64f))),
                              Vec3f(0.05f, -0.02f, 0.1f)};
    const RigidTransform grip{Quatf(Eigen::AngleAxisf(0.4f, Vec3f(1.0f, 0.0f, 0.0f))),
                              Vec3f(0.0f, 0.0f, 0.02f)};
    pbd::Rod rod(Tube{}, {}, grip);
    pbd::Rod turned(Tube{}, {}, turn * grip);
    test::run(rod, 0.5, rod_dt, rod_gravity, grip, {0.01f, 0.0f, 0.0f});
    test::run(turned, 0.5, rod_dt, turn.rotation * rod_gravity, turn * grip,
              turn.rotation * Vec3f(0.01f, 0.0f, 0.0f));
    const std::vector<Vec3f> a = nodes_of(rod);
    const std::vector<Vec3f> b = nodes_of(turned);
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_LT((turn * a[i] - b[i]).norm(), 1e-6f);
    }
}

TEST(Rod, SameInputsGiveTheSameBits) {
    pbd::Rod one(Tube{}, {}, {});
    pbd::Rod two(Tube{}, {}, {});
    for (pbd::Rod* rod : {&one, &two}) {
        test::run(*rod, 0.3, rod_dt, rod_gravity, {}, {0.02f, 0.01f, -0.05f}, 2);
    }
    EXPECT_EQ(std::memcmp(one.segments().data(), two.segments().data(), one.segments().size_bytes()), 0);
}

TEST(Rod, StepsWithoutAllocating) {
    pbd::Rod rod(Tube{}, {}, {});
    std::vector<Vec3f> nodes(rod.size() + 1);
    const long before = test::allocations();
    test::run(rod, 0.1, rod_dt, rod_gravity, {}, {0.0f, 0.1f, 0.0f}, 3);
    rod.nodes(nodes);
    EXPECT_GT(rod.grip_wrench().force.norm(), 0.0f);
    EXPECT_EQ(test::allocations(), before);
    const std::vector<float> counted(3);  // verifies that the counter works
    EXPECT_EQ(test::allocations(), before + 1) << counted.size();
}

class RodRobustness : public testing::TestWithParam<float> {};  // Young's modulus [Pa]

// Energy only decreases: implicit steps and viscosity dissipate it. 1e-9 J covers double rounding of sums of
// 1e-3 J and of the stretch energy, whose stiffness is 1e4 N/m and more.
TEST_P(RodRobustness, TangledStartSettlesToUndisturbedRest) {
    Tube tube;
    tube.youngs_modulus = GetParam();
    const pbd::RodSettings settings = test::damped(32);
    pbd::Rod quiet(tube, settings, {});
    test::run(quiet, test::settled, rod_dt, rod_gravity, {});
    Random random(3);
    for (int trial = 0; trial < 3; ++trial) {
        pbd::Rod rod(tube, settings, {});
        for (std::size_t i = 0; i < rod.size(); ++i) {
            const Quatf turn(random.normal(), random.normal(), random.normal(), random.normal());
            rod.place(i,
                      {turn.normalized(), 0.05f * Vec3f(random.normal(), random.normal(), random.normal())});
        }
        test::run(rod, 1.5 * test::settled, rod_dt, rod_gravity, {});
        EXPECT_LT(largest_distance(nodes_of(rod), nodes_of(quiet)), 1e-4f);
    }
}

TEST_P(RodRobustness, ElasticEnergyNeverIncreases) {
    Tube tube;
    tube.youngs_modulus = GetParam();
    pbd::RodSettings settings;
    settings.velocity_damping = 0.0f;
    pbd::Rod rod(tube, settings, {});
    // Pulled to a side and released.
    test::run(rod, 0.3, rod_dt, Vec3f::Zero(), {}, {0.05f, 0.02f, 0.0f});
    const double start = rod.energy();
    double before = start;
    EXPECT_GT(start, 1e-5);
    for (int i = 0; i < 1000; ++i) {
        test::run(rod, double{rod_dt}, rod_dt, Vec3f::Zero(), {});
        const double now = rod.energy();
        ASSERT_LE(now, before + 1e-9);
        before = now;
    }
    EXPECT_LT(before, 0.9 * start);
}

TEST_P(RodRobustness, RecoversFromStretchAndGripJump) {
    Tube tube;
    tube.youngs_modulus = GetParam();
    const pbd::RodSettings settings = test::damped(32);
    pbd::Rod quiet(tube, settings, {});
    test::run(quiet, test::settled, rod_dt, rod_gravity, {});
    pbd::Rod stretched(tube, settings, {});
    for (std::size_t i = 0; i < stretched.size(); ++i) {
        RigidTransform pose = stretched.pose(i);
        pose.translation *= 10.0f;
        stretched.place(i, pose);
    }
    test::run(stretched, 1.5 * test::settled, rod_dt, rod_gravity, {});
    EXPECT_LT(largest_distance(nodes_of(stretched), nodes_of(quiet)), 1e-4f);

    pbd::Rod jumped(tube, settings, {});
    const RigidTransform there{Quatf::Identity(), Vec3f(0.03f, 0.0f, -0.04f)};  // 50 mm away
    // A pass rotates segments by half a radian at most; after fifty of them the gap is negligible.
    test::run(jumped, 50.0 * double{rod_dt}, rod_dt, rod_gravity, there);
    EXPECT_LT(largest_gap(jumped), 0.01f * 0.005f);
    test::run(jumped, 1.5 * test::settled, rod_dt, rod_gravity, there);
    std::vector<Vec3f> expected = nodes_of(quiet);
    for (Vec3f& node : expected) {
        node += there.translation;
    }
    EXPECT_LT(largest_distance(nodes_of(jumped), expected), 1e-4f);
}

// A hand that shakes the grip at up to 1 m/s, 4 Hz. The joints stay closed to within a hundredth of a
// segment, and no node is faster than the hand by more than whip and sag explain (ten times).
TEST_P(RodRobustness, FollowsAHandAtOneMetrePerSecond) {
    Tube tube;
    tube.youngs_modulus = GetParam();
    pbd::Rod rod(tube, {}, {});
    const float rate = 2.0f * 3.14159265f * 4.0f;
    std::vector<Vec3f> before = nodes_of(rod);
    for (int i = 1; i <= 1440; ++i) {
        const float t = static_cast<float>(i) * rod_dt;
        const RigidTransform grip{Quatf(Eigen::AngleAxisf(0.3f * std::sin(rate * t), Vec3f::UnitX())),
                                  Vec3f(0.0f, std::sin(rate * t) / rate, 0.0f)};
        test::run(rod, double{rod_dt}, rod_dt, rod_gravity, grip);
        ASSERT_LT(largest_gap(rod), 0.01f * rod.length(0));
        const std::vector<Vec3f> now = nodes_of(rod);
        ASSERT_LT(largest_distance(now, before), 10.0f * rod_dt);
        ASSERT_LT((rod.pose(rod.held()).translation - grip.translation).norm(), 1e-7f);
        before = now;
    }
}

// EI of 0.5, 1.7 and 5 e-4 N m^2.
INSTANTIATE_TEST_SUITE_P(Stiffness, RodRobustness, testing::Values(4.4e6f, 15e6f, 44e6f));

// Settings at the limits of a scenario's range.
TEST(Rod, CanBeGrippedAnywhereAlongItsLength) {
    for (const float from_tip : {0.0f, 0.001f, 0.08f, 0.159f, 0.16f}) {
        for (const int segments : {2, 3, 32, 64}) {
            Tube tube;
            tube.grip_from_tip = from_tip;
            pbd::RodSettings settings;
            settings.segments = segments;
            pbd::Rod rod(tube, settings, {});
            double length = 0.0;
            for (std::size_t i = 0; i < rod.size(); ++i) {
                length += double{rod.length(i)};
            }
            EXPECT_NEAR(length, 0.16, 1e-6) << from_tip << " " << segments;
            test::run(rod, 0.2, rod_dt, rod_gravity, {});
            EXPECT_TRUE(rod.tip().allFinite()) << from_tip << " " << segments;
            EXPECT_LT(largest_gap(rod), 1e-4f) << from_tip << " " << segments;
        }
    }
}

}  // namespace
}  // namespace eti
