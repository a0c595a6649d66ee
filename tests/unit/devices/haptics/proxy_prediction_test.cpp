// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/proxy_prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace eti::devices {
namespace {

const PredictionBounds bounds;

Motion device_at(const Vec3f& position, const Vec3f& velocity = Vec3f::Zero()) {
    return {{Quatf::Identity(), position}, velocity, Vec3f::Zero()};
}

/// Proxy held at y = 0 by a floor, the device `depth` beneath it.
ProxyReport on_floor(float depth) {
    ProxyReport report;
    report.device.translation = {0, -depth, 0};
    report.normals[0] = Vec3f::UnitY();
    report.contacts = 1;
    return report;
}

TEST(PredictedProxy, FreeProxyFollowsTheDevice) {
    ProxyReport report;
    const Quatf tilt = quaternion_from({0.3f, 0.1f, 0.0f});
    report.device = {tilt, {0.1f, 0.2f, 0.3f}};
    report.proxy.pose = report.device;
    Motion device = device_at({0.11f, 0.19f, 0.3f}, {0.2f, 0, 0});
    device.pose.rotation = quaternion_from({0, 0, 0.2f}) * tilt;
    device.angular_velocity = {0, 0, 2};
    const auto proxy = predicted_proxy(device, report, 0.005f, 1.0f, bounds);
    ASSERT_TRUE(proxy);
    EXPECT_LT((proxy->pose.translation - device.pose.translation).norm(), 1e-7f);
    EXPECT_LT(rotation_vector(proxy->pose.rotation * device.pose.rotation.conjugate()).norm(), 1e-6f);
    EXPECT_EQ(proxy->velocity, device.velocity);
    EXPECT_EQ(proxy->angular_velocity, device.angular_velocity);
}

// Trailing by less than a step's motion is an artefact of the simulation; a larger offset is due to contact,
// as for a pressed proxy that lifted off its contact for a step.
TEST(PredictedProxy, IgnoresTheLagOfAFreeProxy) {
    ProxyReport report;
    report.proxy.pose.translation = {-1e-3f, 0, 0};
    const auto offset = [&](float speed, float pace) {
        return predicted_proxy(device_at(Vec3f::Zero(), {0, speed, 0}), report, 0, pace, bounds)
            ->pose.translation.x();
    };
    EXPECT_NEAR(offset(0.0f, 1.0f), -1e-3f, 1e-9f);
    EXPECT_NEAR(offset(0.09f, 1.0f), -0.5e-3f, 1e-8f);  // 0.09 m/s / 180 Hz = 0.5 mm
    EXPECT_NEAR(offset(0.09f, 0.5f), 0.0f, 1e-8f);      // at half the rate 1 mm
    EXPECT_EQ(offset(0.3f, 1.0f), 0.0f);
    EXPECT_NEAR(offset(0.009f, 0.0f), -0.5e-3f, 1e-8f);  // a tenth of the rate at the least
}

// A report about the time before a stop: the proxy trails by a step's motion at the earlier speed.
TEST(PredictedProxy, DoesNotPullOnAHandThatHasStoppedInFreeAir) {
    ProxyReport report;
    report.proxy.pose.translation = {-0.2f / 180.0f, 0, 0};
    report.proxy.pose.rotation = quaternion_from({0, -2.0f / 180.0f, 0});
    Motion device = device_at(Vec3f::Zero(), {0.2f, 0, 0});
    device.angular_velocity = {0, 2.0f, 0};
    RecentSpeeds speeds(bounds);
    for (int i = 0; i < 300; ++i) {
        (void)speeds.update(device, false, 1e-3f);
    }
    device.velocity = device.angular_velocity = Vec3f::Zero();
    const auto after = [&](bool touching) {
        return *predicted_proxy(device, report, 0, 1.0f, bounds, speeds.update(device, touching, 1e-3f));
    };
    // A hundredth of a step's motion decays in a cycle.
    EXPECT_LT(after(false).pose.translation.norm(), 0.011f * 0.2f / 180.0f);
    EXPECT_LT(rotation_vector(after(false).pose.rotation).norm(), 0.021f * 2.0f / 180.0f);
    // In contact, the force that holds the proxy off is felt.
    EXPECT_EQ(after(true).pose.translation, report.proxy.pose.translation);
    EXPECT_EQ(after(false).pose.translation, report.proxy.pose.translation) << "touched a moment ago";
}

TEST(RecentSpeeds, DecayAndIgnoreNonFiniteSpeed) {
    RecentSpeeds speeds(bounds);
    for (int i = 0; i < 300; ++i) {
        (void)speeds.update(device_at(Vec3f::Zero()), false, 1e-3f);
    }
    (void)speeds.update(device_at(Vec3f::Zero(), {0, 0.3f, 0}), false, 1e-3f);
    Speeds now;
    for (int i = 0; i < 100; ++i) {
        now = speeds.update(device_at(Vec3f::Zero(), {0, 0.01f, 0}), false, 1e-3f);
    }
    EXPECT_NEAR(now.moving, 0.3f * std::exp(-0.1f / bounds.speed_memory), 1e-4f);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    (void)speeds.update(device_at(Vec3f::Zero(), {nan, 0, 0}), false, 1e-3f);
    EXPECT_EQ(speeds.update(device_at(Vec3f::Zero(), {0.1f, 0, 0}), false, 1e-3f).moving, 0.1f);
}

TEST(PredictedProxy, StaysOnFloorUntilTheDeviceLeavesIt) {
    const ProxyReport report = on_floor(3e-3f);
    struct Case {
        float device_y, proxy_y;
    };
    // Deeper, back up, just beneath, just above, well above.
    for (const Case c : {Case{-5e-3f, 0}, {-1e-3f, 0}, {-1e-5f, 0}, {1e-5f, 1e-5f}, {8e-3f, 8e-3f}}) {
        const auto proxy =
            predicted_proxy(device_at({0, c.device_y, 0}, {0, 0.1f, 0}), report, 0.0f, 1.0f, bounds);
        ASSERT_TRUE(proxy);
        EXPECT_NEAR(proxy->pose.translation.y(), c.proxy_y, 1e-8f) << c.device_y;
        EXPECT_EQ(proxy->velocity.y(), c.proxy_y > 0 ? 0.1f : 0.0f);
    }
}

TEST(PredictedProxy, SlidesAlongTheFloorKeepingFrictionsOffset) {
    ProxyReport report = on_floor(3e-3f);
    report.proxy.pose.translation.x() = -0.4e-3f;  // held back by friction
    const auto proxy =
        predicted_proxy(device_at({2e-3f, -3e-3f, 1e-3f}, {0.1f, -0.05f, 0}), report, 0.0f, 1.0f, bounds);
    ASSERT_TRUE(proxy);
    EXPECT_LT((proxy->pose.translation - Vec3f(1.6e-3f, 0, 1e-3f)).norm(), 1e-7f);
    EXPECT_LT((proxy->velocity - Vec3f(0.1f, 0, 0)).norm(), 1e-7f);
}

TEST(PredictedProxy, StaysInACorner) {
    ProxyReport report;
    report.device.translation = {-2e-3f, -2e-3f, 0};
    report.normals[0] = Vec3f::UnitY();
    report.normals[1] = Vec3f(1, -1, 0).normalized();  // 135 deg from the other: an acute corner
    report.normals[2] = Vec3f::UnitY();                // contacts come in pairs
    report.contacts = 3;
    const auto proxy = predicted_proxy(device_at({-3e-3f, -2.5e-3f, 0}), report, 0.0f, 1.0f, bounds);
    ASSERT_TRUE(proxy);
    // Alternating projections onto planes at 45 deg halve the error squared each sweep: 4 sweeps leave less
    // than a tenth of the 3.9 mm; the exact answer is the corner itself.
    EXPECT_LT(proxy->pose.translation.norm(), 0.4e-3f);
}

// Pushed into the floor and pulled out between two reports, the spring returns the energy it took: the force
// depends on the depth alone.
TEST(PredictedProxy, ReturnsNoMoreEnergyThanItTook) {
    const ProxyReport report = on_floor(1e-3f);
    const CouplingSettings coupling;
    double work = 0.0;
    const int steps = 200;
    float last = -1e-3f;
    for (int i = 1; i <= steps; ++i) {
        const float phase =
            2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(steps);
        const float y = -1e-3f - 3e-3f * std::sin(0.5f * phase) * std::sin(0.5f * phase);
        const auto force = [&](float at) {
            return coupling_wrench(device_at({0, at, 0}),
                                   *predicted_proxy(device_at({0, at, 0}), report, 0, 1.0f, bounds), coupling)
                .force.y();
        };
        work += 0.5 * static_cast<double>((force(y) + force(last)) * (y - last));
        last = y;
    }
    // Exactly closed except for rounding of 200 products of about 4e-6 J at float precision.
    EXPECT_LT(std::abs(work), 1e-8);
}

TEST(PredictedProxy, RotationIsExtrapolatedForABoundedTime) {
    ProxyReport report = on_floor(1e-3f);
    report.proxy.angular_velocity = {0, 0, 3.0f};
    const auto angle = [&](float age) {
        return rotation_vector(
                   predicted_proxy(device_at({0, -1e-3f, 0}), report, age, 1.0f, bounds)->pose.rotation)
            .z();
    };
    EXPECT_NEAR(angle(0.005f), 0.015f, 1e-6f);
    EXPECT_NEAR(angle(10.0f), 3.0f * bounds.turning_time, 1e-6f);
    EXPECT_NEAR(angle(-1.0f), 0.0f, 1e-7f);
}

std::optional<Motion> held(const Motion& device, const ProxyReport& report) {
    return predicted_proxy(device, report, 0.1f, 1.0f, bounds, {}, true);
}

TEST(PredictedProxy, HeldPlanesAreStaticAndOnlyResist) {
    ProxyReport report = on_floor(3e-3f);
    report.proxy.velocity = {0, 0.5f, 0};
    for (const auto& [device_y, proxy_y] :
         {std::pair{-5e-3f, 0.0f}, {-3e-3f, 0.0f}, {-1e-5f, 0.0f}, {2e-3f, 2e-3f}}) {
        const auto proxy = held(device_at({0, device_y, 0}, {0.1f, -0.1f, 0}), report);
        ASSERT_TRUE(proxy);
        EXPECT_NEAR(proxy->pose.translation.y(), proxy_y, 1e-8f) << device_y;
        EXPECT_EQ(proxy->velocity.x(), 0.1f) << "it slides";
    }
}

// Friction of 0.4 mm against 800 N/m: a hand that retreats by as much is pushed no farther, and one that
// moves on is held back by no more than before.
TEST(PredictedProxy, HeldResidualOffsetIsConsumed) {
    ProxyReport report = on_floor(3e-3f);
    report.proxy.pose.translation.x() = -0.4e-3f;
    const auto offset = [&](float x) {
        return held(device_at({x, -3e-3f, 0}), report)->pose.translation.x() - x;
    };
    EXPECT_NEAR(offset(0.0f), -0.4e-3f, 1e-8f);
    EXPECT_NEAR(offset(-0.1e-3f), -0.3e-3f, 1e-8f);
    EXPECT_NEAR(offset(-0.4e-3f), 0.0f, 1e-8f);
    EXPECT_NEAR(offset(-2e-3f), 0.0f, 1e-8f);
    EXPECT_NEAR(offset(2e-3f), -0.4e-3f, 1e-8f);
    // A pressed proxy that had lifted off its contact for a step, likewise.
    report.contacts = 0;
    report.proxy.pose.translation = Vec3f::Zero();
    const auto lift = [&](float y) { return held(device_at({0, y, 0}), report)->pose.translation.y() - y; };
    EXPECT_NEAR(lift(-3e-3f), 3e-3f, 1e-8f);
    EXPECT_NEAR(lift(-1e-3f), 1e-3f, 1e-8f);
    EXPECT_NEAR(lift(1e-3f), 0.0f, 1e-8f);
    EXPECT_NEAR(lift(-4e-3f), 3e-3f, 1e-8f);
}

// Levered on a floor 60 mm ahead of the grip, turned 0.02 rad into it about x.
TEST(PredictedProxy, HeldRotationResistsOnlyIntoThePlanes) {
    ProxyReport report = on_floor(0.0f);
    report.contact_centre = {0, 0, 0.06f};
    report.device.rotation = quaternion_from({0.02f, 0, 0});
    report.proxy.angular_velocity = {-1.0f, 0, 0};
    const float ahead = -bounds.turning_time;  // time over which the report's rotation is extrapolated
    const auto turn = [&](const Vec3f& device) {
        Motion at = device_at(Vec3f::Zero());
        at.pose.rotation = quaternion_from(device);
        at.angular_velocity = {0.5f, 0, 0.3f};
        return *held(at, report);
    };
    EXPECT_NEAR(rotation_vector(turn({0.02f, 0, 0}).pose.rotation).x(), ahead, 1e-5f);
    EXPECT_NEAR(rotation_vector(turn({0.05f, 0, 0}).pose.rotation).x(), ahead, 1e-5f);
    EXPECT_NEAR(rotation_vector(turn({-0.05f, 0, 0}).pose.rotation).x(), -0.05f, 1e-5f);
    EXPECT_NEAR(rotation_vector(turn({0.02f, 0, 0.1f}).pose.rotation).z(), 0.1f, 1e-3f);
    EXPECT_LT((turn({0.02f, 0, 0}).angular_velocity - Vec3f(0, 0, 0.3f)).norm(), 1e-6f)
        << "it goes with the device where it may, and is not the report's any more";
}

TEST(PredictedProxy, IsEmptyOutOfBounds) {
    ProxyReport report;
    EXPECT_TRUE(predicted_proxy(device_at({0.029f, 0, 0}), report, 0, 1.0f, bounds));
    EXPECT_FALSE(predicted_proxy(device_at({0.031f, 0, 0}), report, 0, 1.0f, bounds));
    EXPECT_FALSE(
        predicted_proxy(device_at({std::numeric_limits<float>::quiet_NaN(), 0, 0}), report, 0, 1.0f, bounds));
}

}  // namespace
}  // namespace eti::devices
