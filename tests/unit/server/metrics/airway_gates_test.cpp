// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/airway_gates.hpp"

#include <gtest/gtest.h>

#include "airway_shapes.hpp"
#include "common/math/units.hpp"
#include "server/metrics/airway_watch.hpp"

namespace eti::metrics {
namespace {

using test::plain_snapshot;
using Change = GateTracker::Change;

// Points of a few centimetres in float: a micrometre leaves a hundred-fold margin.
constexpr float near = 1e-6f;

TEST(AirwayGates, GatesFaceIntoTheAirway) {
    const AirwayGates places = airway_gates(plain_snapshot());
    EXPECT_LT((places.mouth.onward - Vec3f::UnitY()).norm(), near);
    EXPECT_LT((places.glottis.onward + Vec3f::UnitZ()).norm(), near);
    EXPECT_LT((places.oesophagus.onward + Vec3f::UnitZ()).norm(), near);
    EXPECT_NEAR(places.mouth.past({0.004f, 0.02f, 0.003f}), 0.03f, near);
    EXPECT_NEAR(places.mouth.radial_distance({0.004f, 0.02f, -0.007f}), 0.005f, near);
    EXPECT_NEAR(places.trachea_length(), 0.05f, near);
}

TEST(AirwayGates, ClosedMouthGateFacesInwards) {
    scene::Snapshot snapshot = plain_snapshot();
    snapshot.landmarks[static_cast<std::size_t>(Landmark::lower_lip)] = Vec3f(0, -0.01f, -0.001f);
    EXPECT_GT(airway_gates(snapshot).mouth.onward.y(), 0.99f);
}

TEST(AirwayGates, TiltedHeadTiltsMouthGate) {
    scene::Snapshot snapshot = plain_snapshot();
    const RigidTransform tilt = RigidTransform::about({0, 0.05f, 0}, Vec3f::UnitX(), 20 * degree);
    for (const Landmark which :
         {Landmark::upper_lip, Landmark::lower_lip, Landmark::mouth_opening, Landmark::tongue_dorsum}) {
        Vec3f& point = snapshot.landmarks[static_cast<std::size_t>(which)];
        point = tilt * point;
    }
    EXPECT_LT((airway_gates(snapshot).mouth.onward - tilt.rotation * Vec3f::UnitY()).norm(), 10 * near);
}

TEST(AirwayGates, LengthAlongTheTrachea) {
    const AirwayGates places = airway_gates(plain_snapshot());
    EXPECT_NEAR(places.along_trachea({0.001f, 0.035f, -0.07f}), 0.01f, near);
    EXPECT_NEAR(places.along_trachea({0, 0.036f, -0.10f}), 0.04f, near);
    EXPECT_NEAR(places.along_trachea({0, 0.035f, -0.12f}), 0.06f, near);
    EXPECT_NEAR(places.along_trachea({0, 0.035f, -0.05f}), -0.01f, near);
    EXPECT_NEAR(places.from_trachea({0.002f, 0.035f, -0.1f}), 0.002f, near);
    EXPECT_NEAR(places.from_oesophagus({0, 0.045f, -0.2f}), 0.002f, near);
}

TEST(AirwayGates, TubeDepthIsMeasuredAlongTheTube) {
    const AirwayGates places = airway_gates(plain_snapshot());
    const test::Path path = test::tracheal_path();
    const float to_mouth = path.length_to(1);
    for (const float inside : {0.01f, 0.05f, 0.1f}) {
        const auto depth = depth_at_lip(test::tube_on(path, to_mouth + inside), places.mouth);
        ASSERT_TRUE(depth.has_value());
        // Half-millimetre nodes cut the path's two corners: each by less than half a node distance.
        EXPECT_NEAR(*depth, inside, 0.5e-3f);
    }
    EXPECT_FALSE(depth_at_lip(test::tube_on(path, to_mouth - 0.01f), places.mouth).has_value());
}

TEST(AirwayGates, BladeAnglesMatchConstructedDirection) {
    scene::Snapshot snapshot = plain_snapshot();
    const RigidTransform skull =
        RigidTransform::about(Vec3f::Zero(), Vec3f(1, 0.2f, -0.3f).normalized(), 0.7f);
    for (const float pitch : {-10.0f, 0.0f, 45.0f, 90.0f, 120.0f}) {
        for (const float yaw : {-30.0f, 0.0f, 12.0f}) {
            const float p = pitch * degree;
            const float q = yaw * degree;
            const Vec3f direction(std::sin(q), std::cos(q) * std::cos(p), -std::cos(q) * std::sin(p));
            snapshot.proxy.rotation = Quatf::FromTwoVectors(Vec3f::UnitZ(), direction);
            snapshot.frames[1].rotation = Quatf::Identity();
            const BladeAngles plain = blade_angles(snapshot);
            EXPECT_NEAR(plain.pitch, static_cast<double>(p), 1e-5);
            EXPECT_NEAR(plain.yaw, static_cast<double>(q), 1e-5);
            // The same with head and blade rotated together.
            snapshot.frames[1].rotation = skull.rotation;
            snapshot.proxy.rotation = skull.rotation * snapshot.proxy.rotation;
            const BladeAngles turned = blade_angles(snapshot);
            EXPECT_NEAR(turned.pitch, static_cast<double>(p), 1e-5);
            EXPECT_NEAR(turned.yaw, static_cast<double>(q), 1e-5);
        }
    }
}

TEST(AirwayWatch, TremblingTipIsCountedOnce) {
    const AirwayGates places = airway_gates(plain_snapshot());
    AirwayWatch watch;
    int entries = 0;
    int exits = 0;
    for (int i = 0; i < 2000; ++i) {
        // From 10 mm before the inlet to 10 mm past it and back, with 1.5 mm of tremor.
        const float way = 0.01f * (1.0f - 2.0f * std::abs(1.0f - static_cast<float>(i) / 1000.0f));
        const float z = -0.065f - way - 0.0015f * std::sin(1.7f * static_cast<float>(i));
        const auto changes = watch.update({0.001f, 0.046f, z}, places);
        entries += changes.oesophagus == Change::in ? 1 : 0;
        exits += changes.oesophagus == Change::out ? 1 : 0;
        EXPECT_EQ(changes.trachea, Change::none);
    }
    EXPECT_EQ(entries, 1);
    EXPECT_EQ(exits, 1);
}

TEST(AirwayWatch, FollowsTheTubeDownTheTracheaAndBack) {
    const AirwayGates places = airway_gates(plain_snapshot());
    const test::Path path = test::tracheal_path();
    AirwayWatch watch;
    std::vector<std::string> story;
    for (int i = 0; i <= 1200; ++i) {
        const float tip = 0.1f + 0.2f * (1.0f - std::abs(1.0f - static_cast<float>(i) / 600.0f));
        const auto changes = watch.update(path.at(tip), places);
        const auto tell = [&](Change change, const char* place) {
            if (change != Change::none) {
                story.push_back((change == Change::in ? "in " : "out ") + std::string(place));
            }
        };
        tell(changes.mouth, "mouth");
        tell(changes.trachea, "trachea");
        tell(changes.main_stem, "main stem");
        tell(changes.oesophagus, "oesophagus");
    }
    const std::vector<std::string> expected = {"in mouth",      "in trachea",  "in main stem",
                                               "out main stem", "out trachea", "out mouth"};
    EXPECT_EQ(story, expected);
}

// Past the carina a bronchus leads away from the trachea's line, here to where the oesophagus is nearer.
TEST(AirwayWatch, TubeInBronchusCountsAsOneTrachealEntry) {
    const AirwayGates places = airway_gates(plain_snapshot());
    test::Path path = test::tracheal_path();
    path.points.push_back(path.points.back() + Vec3f(0.004f, 0.014f, -0.02f));
    const float carina = path.length_to(4);
    AirwayWatch watch;
    int trachea = 0, main_stem = 0, oesophagus = 0;
    for (int i = 0; i <= 4000; ++i) {
        const float tip = carina - 0.06f + 0.08f * static_cast<float>(i) / 4000.0f;
        const Vec3f tremor(0, 0.001f * std::sin(1.7f * static_cast<float>(i)), 0);
        const auto changes = watch.update(path.at(tip) + tremor, places);
        trachea += changes.trachea != Change::none ? 1 : 0;
        main_stem += changes.main_stem != Change::none ? 1 : 0;
        oesophagus += changes.oesophagus != Change::none ? 1 : 0;
    }
    EXPECT_GT(places.from_trachea(path.points.back()), places.from_oesophagus(path.points.back()))
        << "nearness alone tells it wrongly";
    EXPECT_EQ(trachea, 1);
    EXPECT_EQ(main_stem, 1);
    EXPECT_EQ(oesophagus, 0);
    EXPECT_TRUE(watch.in_main_stem());
}

TEST(AirwayWatch, DeepOesophagealTubeStaysOesophageal) {
    const AirwayGates places = airway_gates(plain_snapshot());
    test::Path path = test::oesophageal_path();
    path.points.push_back({0, 0.047f, -0.11f});
    path.points.push_back({0, 0.039f, -0.14f});  // nearer to the trachea's line, which has ended
    AirwayWatch watch;
    int changes_seen = 0;
    for (int i = 0; i <= 2000; ++i) {
        const auto changes =
            watch.update(path.at(path.length_to(5) * static_cast<float>(i) / 2000.0f), places);
        changes_seen += changes.oesophagus != Change::none || changes.trachea != Change::none ? 1 : 0;
    }
    EXPECT_EQ(changes_seen, 1);
    EXPECT_TRUE(watch.in_oesophagus());
}

TEST(AirwayWatch, TipBesideTheFaceIsNotInTheMouth) {
    const AirwayGates places = airway_gates(plain_snapshot());
    AirwayWatch watch;
    for (int i = 0; i < 100; ++i) {
        watch.update({0.07f, -0.1f + 0.002f * static_cast<float>(i), -0.01f}, places);
        EXPECT_FALSE(watch.in_mouth());
    }
}

}  // namespace
}  // namespace eti::metrics
