// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue/self_contact_finder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::scene {
namespace {

constexpr double cell = 2e-3;  // [m]

/// A bar of 40 x 8 x 8 mm whose right half is turned by 180 degrees about y and laid `overlap` [m] deep into
/// the lower side of the left half. The cells between the halves are torn apart and ignored.
struct FoldedBar {
    test::TetrahedralLattice lattice = test::tetrahedral_lattice(20, 4, 4, cell);
    pbd::Particles particles;
    SelfContactFinder finder;

    explicit FoldedBar(double overlap, std::vector<std::uint32_t> neighbours = {}) {
        SelfContactFinder::Description description;
        particles.resize(lattice.position.size());
        description.free.assign(particles.size(), true);
        for (std::size_t i = 0; i < particles.size(); ++i) {
            const Vec3d x = lattice.position[i];
            description.rest.push_back(x.cast<float>());
            const Vec3d turned(40e-3 - x.x(), x.y(), overlap - x.z());
            particles.predicted[i] = (x.x() > 19e-3 ? turned : x).cast<float>();
        }
        for (const auto& corners : lattice.tetrahedra) {
            double left = 1.0;
            double right = 0.0;
            for (const std::uint32_t i : corners) {
                left = std::min(left, lattice.position[i].x());
                right = std::max(right, lattice.position[i].x());
            }
            if (right < 19e-3 || left > 19e-3) {
                description.solid.push_back(corners);
            }
        }
        description.neighbours = std::move(neighbours);
        finder.configure(description);
    }

    std::vector<pbd::MeshContact> find() {
        std::vector<pbd::MeshContact> found;
        finder.find(particles, found);
        return found;
    }
};

TEST(SelfContactFinder, UnfoldedBarHasNoContacts) {
    FoldedBar bar(-1e-3);
    EXPECT_TRUE(bar.find().empty());
}

// Points of one half's lower side lie `overlap` deep in the other. Rest depth is 0.3 mm and a step corrects
// at most 1 mm.
TEST(SelfContactFinder, PointsLeaveThroughNearestSide) {
    constexpr double overlap = 0.9e-3;
    FoldedBar bar(overlap);
    const std::vector<pbd::MeshContact> found = bar.find();
    // Inner points of both sides: 8 or 9 along by 3 across; those on the bar's rims may leave sideways.
    EXPECT_GE(found.size(), 48u);
    for (const pbd::MeshContact& contact : found) {
        const Vec3d place = bar.lattice.position[contact.particle[0]];
        float sum = 0.0f;
        Vec3f inside = Vec3f::Zero();
        for (std::size_t k = 0; k < contact.corners; ++k) {
            sum += contact.share[k];
            inside += contact.share[k] * bar.particles.predicted[contact.particle[k]];
        }
        EXPECT_NEAR(sum, 0.0f, 1e-5f);
        EXPECT_LT(inside.norm(), 1e-6f);  // the point lies where its corners' shares say
        const bool inner = place.y() > cell && place.y() < 3 * cell && place.x() > 4e-3 &&
                           place.x() < 36e-3 && std::fabs(place.x() - 20e-3) > 5e-3;
        if (inner) {
            // Out of the left half is down, out of the right half is up.
            EXPECT_NEAR(contact.normal.z(), place.x() > 20e-3 ? -1.0f : 1.0f, 0.02f);
            EXPECT_NEAR(contact.gap, 0.3e-3 - overlap, 0.05e-3);
        }
    }
}

TEST(SelfContactFinder, ForceFadesWhenPointLeaves) {
    FoldedBar bar(0.9e-3);
    std::vector<pbd::MeshContact> contacts;
    bar.finder.find(bar.particles, contacts);
    ASSERT_FALSE(contacts.empty());
    for (pbd::MeshContact& contact : contacts) {
        contact.force = 0.1f * contact.normal;
    }
    for (std::size_t i = 0; i < bar.particles.size(); ++i) {
        if (bar.lattice.position[i].x() > 19e-3) {
            bar.particles.predicted[i].z() -= 5e-3f;
        }
    }
    float last = 0.1f;
    for (int k = 0; k < 60 && !contacts.empty(); ++k) {
        bar.finder.find(bar.particles, contacts);
        for (const pbd::MeshContact& contact : contacts) {
            EXPECT_LT(contact.force.norm(), last);
        }
        last = contacts.empty() ? 0.0f : contacts.front().force.norm() + 1e-9f;
    }
    EXPECT_TRUE(contacts.empty());
}

TEST(SelfContactFinder, NeighbourIsKeptOutToo) {
    // A particle of other tissue: the lattice's last, which no element uses once it is moved into the bar.
    FoldedBar bar(-1e-3, {});
    const auto stranger = static_cast<std::uint32_t>(bar.particles.size());
    SelfContactFinder::Description description;
    for (const Vec3d& x : bar.lattice.position) {
        description.rest.push_back(x.cast<float>());
    }
    description.rest.emplace_back(10e-3f, 4e-3f, -5e-3f);
    description.free.assign(stranger + 1, true);
    description.solid = bar.lattice.tetrahedra;
    description.neighbours = {stranger};
    SelfContactFinder finder;
    finder.configure(description);
    pbd::Particles particles;
    particles.resize(stranger + 1);
    particles.predicted = description.rest;
    particles.predicted[stranger] = Vec3f(10e-3f, 4e-3f, 0.8e-3f);
    std::vector<pbd::MeshContact> found;
    finder.find(particles, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].particle[0], stranger);
    EXPECT_NEAR(found[0].normal.z(), -1.0f, 0.01f);
    EXPECT_NEAR(found[0].gap, -0.5e-3f, 0.05e-3f);
}

}  // namespace
}  // namespace eti::scene
