// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue_contacts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti::scene {
namespace {

constexpr float radius = 3e-3f;  // [m], of the blade's one capsule
constexpr float ball = 0.5e-3f;  // [m], of a particle

/// An edge along x, and a blade along z whose axis passes `height` [m] above it.
class EdgeUnderBlade : public ::testing::Test {
  protected:
    std::vector<pbd::MeshContact> met(float half_length, float height) {
        pbd::Particles particles;
        particles.resize(2);
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3f at(i == 0 ? -half_length : half_length, 0.0f, 0.0f);
            particles.position[i] = particles.predicted[i] = at;
            particles.radius[i] = ball;
        }
        Laryngoscope scope;
        scope.capsules.fill({Vec3f::Ones(), Vec3f::Ones(), 0.0f});  // a metre away
        scope.capsules.back() = {{0.0f, height, -20e-3f}, {0.0f, height, 20e-3f}, radius};
        DistanceGrid nothing;
        nothing.size = {2, 2, 2};
        nothing.value.assign(8, 1.0f);
        TongueContacts contacts;
        contacts.configure({0, 1}, {.particles = {0, 1}, .edges = {{0, 1}}, .triangles = {}});
        std::vector<pbd::MeshContact> found;
        contacts.find(particles, {scope, {}, {}}, {nothing, 1}, found);
        return found;
    }
};

TEST_F(EdgeUnderBlade, ContactIsFoundForAnyEdgeLength) {
    for (const float half_length : {5e-3f, 8e-3f, 12e-3f, 30e-3f}) {
        const std::vector<pbd::MeshContact> found = met(half_length, 2e-3f);
        ASSERT_EQ(found.size(), 1u) << half_length;
        EXPECT_EQ(found[0].corners, 2);
        EXPECT_NEAR(found[0].share[1], 0.5f, 1e-5f);
        EXPECT_NEAR(found[0].gap, 2e-3f - radius - ball, 1e-7f);
        EXPECT_NEAR(found[0].normal.y(), -1.0f, 1e-5f);
    }
}

TEST_F(EdgeUnderBlade, EdgeBesideBladeIsIgnored) {
    EXPECT_TRUE(met(12e-3f, radius + ball + 1e-5f).empty());
}

// A triangle touches at its three Gauss points, so that each contact is borne by all three corners.
TEST(TriangleUnderBlade, ContactPushesNoParticleAlone) {
    pbd::Particles particles;
    particles.resize(3);
    particles.predicted = {Vec3f(-1e-3f, 0.0f, -1e-3f), Vec3f(1e-3f, 0.0f, -1e-3f), Vec3f(0.0f, 0.0f, 1e-3f)};
    particles.position = particles.predicted;
    particles.radius.assign(3, ball);
    Laryngoscope scope;
    scope.capsules.fill({Vec3f::Ones(), Vec3f::Ones(), 0.0f});  // a metre away
    scope.capsules.back() = {{0.0f, 2e-3f, -20e-3f}, {0.0f, 2e-3f, 20e-3f}, radius};
    DistanceGrid nothing;
    nothing.size = {2, 2, 2};
    nothing.value.assign(8, 1.0f);
    TongueContacts contacts;
    contacts.configure({0, 1, 2}, {.particles = {}, .edges = {}, .triangles = {{0, 1, 2}}});
    std::vector<pbd::MeshContact> found;
    contacts.find(particles, {scope, {}, {}}, {nothing, 1}, found);
    ASSERT_EQ(found.size(), 3u);
    float area = 0.0f;
    for (const pbd::MeshContact& contact : found) {
        ASSERT_EQ(contact.corners, 3);
        Vec3f point = Vec3f::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_GT(contact.share[k], 0.1f);
            point += contact.share[k] * particles.predicted[contact.particle[k]];
        }
        const float distance = std::hypot(point.x(), 2e-3f);
        EXPECT_NEAR(contact.gap, distance - radius - ball, 1e-7f);
        EXPECT_LT(contact.normal.y(), -0.9f);
        area += contact.area_share;
    }
    EXPECT_NEAR(area, 2.0f, 1e-5f);
}

}  // namespace
}  // namespace eti::scene
