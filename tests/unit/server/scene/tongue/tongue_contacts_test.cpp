// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue/tongue_contacts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti::scene {
namespace {

constexpr float radius = 3e-3f;  // [m], of the blade's one capsule
constexpr float ball = 0.5e-3f;  // [m], of a particle

/// A triangle of particles, and a blade along z whose axis passes `height` [m] above it.
class TriangleUnderBlade : public ::testing::Test {
  protected:
    TriangleUnderBlade() {
        particles_.resize(3);
        particles_.predicted = {Vec3f(-1e-3f, 0.0f, -1e-3f), Vec3f(1e-3f, 0.0f, -1e-3f),
                                Vec3f(0.0f, 0.0f, 1e-3f)};
        particles_.position = particles_.predicted;
        particles_.radius.assign(3, ball);
    }
    [[nodiscard]] std::vector<pbd::MeshContact> met(float height) const {
        Laryngoscope scope;
        scope.capsules.fill({Vec3f::Ones(), Vec3f::Ones(), 0.0f});  // a metre away
        scope.capsules.back() = {{0.0f, height, -20e-3f}, {0.0f, height, 20e-3f}, radius};
        DistanceGrid nothing;
        nothing.size = {2, 2, 2};
        nothing.value.assign(8, 1.0f);
        TongueContacts contacts;
        contacts.configure({0, 1, 2}, {.particles = {}, .triangles = {{0, 1, 2}}});
        std::vector<pbd::MeshContact> found;
        contacts.find(particles_, {scope, {}, {}}, {nothing, 1}, found);
        return found;
    }
    pbd::Particles particles_;
};

// Its three Gauss points are in contact, each borne by all three corners.
TEST_F(TriangleUnderBlade, ContactPushesNoParticleAlone) {
    const std::vector<pbd::MeshContact> found = met(2e-3f);
    ASSERT_EQ(found.size(), 3u);
    float area = 0.0f;
    for (const pbd::MeshContact& contact : found) {
        ASSERT_EQ(contact.corners, 3);
        Vec3f point = Vec3f::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_GT(contact.share[k], 0.1f);
            point += contact.share[k] * particles_.predicted[contact.particle[k]];
        }
        const float distance = std::hypot(point.x(), 2e-3f);
        EXPECT_NEAR(contact.gap, distance - radius - ball, 1e-7f);
        EXPECT_LT(contact.normal.y(), -0.9f);
        area += contact.area_share;
    }
    EXPECT_NEAR(area, 2.0f, 1e-5f);
}

TEST_F(TriangleUnderBlade, TriangleOutOfReachIsIgnored) {
    EXPECT_TRUE(met(radius + ball + 1e-5f).empty());
}

}  // namespace
}  // namespace eti::scene
