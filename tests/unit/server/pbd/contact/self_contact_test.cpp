// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/self_contact.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

namespace eti::pbd {
namespace {

constexpr float radius = 1e-3f;
constexpr float self_contact_dt = 1.0f / 1440.0f;  // [s]; pushes do not depend on it

Particles particles_at(const std::vector<Vec3f>& at) {
    Particles p;
    p.resize(at.size());
    p.rest = p.position = p.predicted = at;
    p.inverse_mass.assign(at.size(), 1e3f);
    p.radius.assign(at.size(), radius);
    return p;
}

std::vector<std::uint32_t> all(const Particles& p) {
    std::vector<std::uint32_t> who(p.size());
    std::iota(who.begin(), who.end(), 0u);
    return who;
}

TEST(SelfContact, SeparatesOverlapInProportionToInverseMass) {
    Particles p = particles_at({{0, 0, 0}, {0.01f, 0, 0}});
    p.inverse_mass = {1e3f, 3e3f};
    SelfContact contact;
    contact.configure(all(p), {}, {}, p);
    p.position[1] = p.predicted[1] = Vec3f(1.2e-3f, 0, 0);
    contact.find(p);
    contact.project(p, self_contact_dt);
    // An overlap of 0.8 mm, a quarter of it for the particle that is three times as heavy.
    EXPECT_NEAR(p.predicted[0].x(), -0.2e-3f, 1e-8f);
    EXPECT_NEAR(p.predicted[1].x(), 1.8e-3f, 1e-8f);
}

TEST(SelfContact, IgnoresJoinedDistantAndRestPairs) {
    Particles p = particles_at({{0, 0, 0}, {1.5e-3f, 0, 0}, {0.02f, 0, 0}});
    const std::vector<std::uint32_t> first = {0, 2};
    const std::vector<std::uint32_t> member = {0, 1};
    SelfContact joined;
    joined.configure(all(p), first, member, p);
    SelfContact loose;
    loose.configure(all(p), {}, {}, p);
    // At rest, nearer to each other than their radii, as in the patient.
    loose.find(p);
    const std::vector<Vec3f> before = p.predicted;
    loose.project(p, self_contact_dt);
    EXPECT_EQ(p.predicted, before);
    p.position[1] = p.predicted[1] = Vec3f(1e-3f, 0, 0);
    joined.find(p);
    EXPECT_TRUE(joined.pairs().empty());
    loose.find(p);
    loose.project(p, self_contact_dt);
    EXPECT_NEAR((p.predicted[1] - p.predicted[0]).norm(), 1.5e-3f, 1e-8f);
    EXPECT_EQ(p.predicted[2], before[2]);
}

TEST(SelfContact, IgnoresPairsOfStaticParticles) {
    Particles p = particles_at({{0, 0, 0}, {0.01f, 0, 0}});
    p.inverse_mass = {0.0f, 0.0f};
    SelfContact contact;
    contact.configure(all(p), {}, {}, p);
    p.position[1] = p.predicted[1] = Vec3f(1e-3f, 0, 0);
    contact.find(p);
    EXPECT_TRUE(contact.pairs().empty());
}

TEST(SelfContact, FindsSamePairsAsBruteForce) {
    std::mt19937 draw(7);
    std::uniform_real_distribution<float> place(0.0f, 0.02f);
    std::vector<Vec3f> rest(400);
    std::vector<Vec3f> now(400);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        rest[i] = Vec3f(place(draw), place(draw), place(draw));
        now[i] = Vec3f(place(draw), place(draw), place(draw));
    }
    now[17] = Vec3f(0.5f, 0, 0);  // far outside
    Particles p = particles_at(rest);
    p.position = p.predicted = now;
    SelfContact contact;
    contact.configure(all(p), {}, {}, p);
    contact.find(p);
    std::set<std::array<std::uint32_t, 2>> found(contact.pairs().begin(), contact.pairs().end());
    EXPECT_EQ(found.size(), contact.pairs().size());
    std::set<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t i = 0; i < 400; ++i) {
        for (std::uint32_t j = i + 1; j < 400; ++j) {
            const float touching = std::min(2 * radius, (rest[i] - rest[j]).norm());
            if ((now[i] - now[j]).norm() < touching + contact.margin) {
                expected.insert({i, j});
            }
        }
    }
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace eti::pbd
