// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"

namespace eti::pbd {
namespace {

constexpr float cube_edge = 2e-3f, link_length = 5e-3f;     // [m]
constexpr float tight = 30.0f, loose = 10.0f;               // [N/m], of a link
constexpr float link_dt = 1.0f / 180.0f, drawn_by = 1e-3f;  // [s], [m]

/// A free cube. Links lead from each of its corners to the left, loose, and to the right, tight: to particles
/// outside the mesh or, on the left if wanted, to the corners of a second cube, which is held.
struct LinkedCube {
    Particles particles;
    ImplicitMesh mesh;

    explicit LinkedCube(bool left_is_mesh) {
        particles.resize(24);
        ImplicitMesh::Description description;
        description.hexahedra.poisson_ratio = 0.49f;
        for (std::uint32_t cube = 0; cube < 3; ++cube) {
            Hexahedra::Corners corners{};
            for (std::uint32_t v = 0; v < 8; ++v) {
                const std::uint32_t i = 8 * cube + v;
                corners[v] = i;
                particles.rest[i] =
                    cube_edge * Vec3f(static_cast<float>(v & 1u), static_cast<float>(v >> 1u & 1u),
                                      static_cast<float>(v >> 2u)) +
                    (static_cast<float>(cube) - 1.0f) * link_length * Vec3f::UnitX();
                particles.inverse_mass[i] = cube == 1 ? 1e5f : 0.0f;
            }
            if (cube == 1 || (cube == 0 && left_is_mesh)) {
                description.hexahedra.hexahedra.push_back(corners);
                description.hexahedra.youngs_modulus.push_back(8e3f);
            }
        }
        for (std::uint32_t v = 0; v < 8; ++v) {
            description.links.ends.push_back({8 + v, v});
            description.links.stiffness.push_back(loose);
            description.links.ends.push_back({16 + v, 8 + v});
            description.links.stiffness.push_back(tight);
        }
        particles.position = particles.predicted = particles.rest;
        mesh.configure(description, particles, particles.inverse_mass);
    }

    void step() {
        for (std::size_t i = 0; i < particles.size(); ++i) {
            particles.predicted[i] = particles.position[i];
        }
        mesh.solve(particles, link_dt);
        for (std::uint32_t i = 8; i < 16; ++i) {
            particles.velocity[i] = (particles.predicted[i] - particles.position[i]) / link_dt;
            particles.position[i] = particles.predicted[i];
        }
    }
    void draw_right(float by) {
        for (std::uint32_t i = 16; i < 24; ++i) {
            particles.position[i].x() += by;
        }
    }
    [[nodiscard]] float shift(std::uint32_t corner) const {
        return particles.position[8 + corner].x() - particles.rest[8 + corner].x();
    }
};

TEST(MeshLinks, ShareDisplacementByStiffness) {
    for (const bool left_is_mesh : {false, true}) {
        LinkedCube cube(left_is_mesh);
        cube.draw_right(drawn_by);
        for (int k = 0; k < 400; ++k) {
            cube.step();
        }
        for (std::uint32_t v = 0; v < 8; ++v) {
            EXPECT_NEAR(cube.shift(v), drawn_by * tight / (tight + loose), 1e-3f * drawn_by) << v;
        }
    }
}

TEST(MeshLinks, ForceOnOuterEndIsThatOfTheSpring) {
    LinkedCube cube(false);
    cube.draw_right(drawn_by);
    for (int k = 0; k < 400; ++k) {
        cube.step();
    }
    const float expected = drawn_by * tight * loose / (tight + loose);
    Vec3f left = Vec3f::Zero();
    Vec3f right = Vec3f::Zero();
    cube.mesh.for_outer_ends(cube.particles, [&](std::uint32_t particle, const Vec3f& force) {
        (particle < 8 ? left : right) += force;
    });
    EXPECT_NEAR(left.x(), 8.0f * expected, 0.01f * expected);
    EXPECT_NEAR(right.x(), -8.0f * expected, 0.01f * expected);
}

// A pair of links that each hold the cube where it was would drag on it.
TEST(MeshLinks, DoNotResistSteadyMotion) {
    LinkedCube cube(false);
    cube.mesh.set_link_stiffness(std::vector<float>(16, tight));
    constexpr float way = 0.05e-3f;  // [m] a step
    float lag = 0.0f;
    for (int k = 0; k < 200; ++k) {
        for (std::uint32_t i = 0; i < 8; ++i) {
            cube.particles.position[i].x() += way;
        }
        cube.draw_right(way);
        cube.step();
        lag = cube.particles.position[16].x() - cube.particles.rest[16].x() - cube.shift(0);
    }
    EXPECT_LT(std::abs(lag), 0.02f * way);
}

TEST(MeshLinks, SetStiffnessChangesShares) {
    LinkedCube cube(false);
    std::vector<float> equal(16, loose);
    cube.mesh.set_link_stiffness(equal);
    cube.draw_right(drawn_by);
    for (int k = 0; k < 400; ++k) {
        cube.step();
    }
    EXPECT_NEAR(cube.shift(0), 0.5f * drawn_by, 1e-3f * drawn_by);
}

}  // namespace
}  // namespace eti::pbd
