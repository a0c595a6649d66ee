// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/yielding_bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/pbd/implicit/implicit_mesh.hpp"
#include "tests/support/tetrahedral_body.hpp"

namespace eti::pbd {
namespace {

constexpr float body_dt = 1.0f / 180.0f;

enum class Lowest : bool { held, on_wall };

/// A block of tissue whose lowest layer a body holds, or that lies on a wall which a body carries. The body
/// slides along z (coordinate 0) and turns about the x axis through the origin (coordinate 1), against
/// springs.
struct SprungBlock {
    test::TetrahedralBody body;
    ImplicitMesh mesh;
    YieldingBodies::Vector at = YieldingBodies::Vector::Zero(), speed = YieldingBodies::Vector::Zero();
    std::array<float, 2> stiffness, mass, damping;

    SprungBlock(std::array<float, 2> springs, std::array<float, 2> inertia, std::array<float, 2> dampers,
                Lowest lowest = Lowest::held)
        : body(test::tetrahedral_lattice(4, 4, 3, 2.5e-3), 8e3f, 0.45f),
          stiffness(springs),
          mass(inertia),
          damping(dampers) {
        Particles& p = body.particles;
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            if (p.rest[i].z() >= 1e-6f) {
                continue;
            }
            if (lowest == Lowest::held) {
                p.inverse_mass[i] = 0.0f;
            } else {
                mesh.contacts.push_back(MeshContact::at_particle(i));
                mesh.contacts.back().normal = Vec3f::UnitZ();
            }
        }
        const std::vector<float> moduli(body.lattice.tetrahedra.size(), 8e3f);
        mesh.configure({{body.lattice.tetrahedra, moduli, 0.45f}, {}}, p, p.inverse_mass);
    }

    [[nodiscard]] float moving_mass() const {
        float sum = 0.0f;
        for (std::size_t k = 0; k < mesh.particles().size(); ++k) {
            sum += mesh.inverse_mass(k) > 0.0f ? 1.0f / mesh.inverse_mass(k) : 0.0f;
        }
        return sum;
    }

    void step(const Vec3f& gravity) {
        Particles& p = body.particles;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                p.velocity[i] += body_dt * gravity;
            }
            p.predicted[i] = p.position[i];
        }
        YieldingBodies& bodies = mesh.bodies;
        bodies.matrix.setIdentity();
        bodies.force.setZero();
        for (int c = 0; c < 2; ++c) {
            const auto n = static_cast<std::size_t>(c);
            bodies.matrix(c, c) = mass[n] / (body_dt * body_dt) + damping[n] / body_dt + stiffness[n];
            bodies.force[c] = mass[n] / body_dt * speed[c] - stiffness[n] * at[c];
        }
        bodies.jacobian.clear();
        for (const std::uint32_t k : mesh.held()) {
            YieldingBodies::Columns columns;
            columns.fill(Eigen::Vector4f::Zero());
            columns[0].z() = 1.0f;
            columns[1].head<3>() = Vec3f::UnitX().cross(p.position[mesh.particles()[k]]);
            bodies.jacobian.push_back(columns);
        }
        bodies.far_ends.clear();
        for (MeshContact& contact : mesh.contacts) {
            contact.gap = p.position[contact.particle[0]].z() - at[0];
            YieldingBodies::Columns columns;
            columns.fill(Eigen::Vector4f::Zero());
            columns[0].z() = 1.0f;
            contact.far_end = bodies.add_far_end(columns);
        }
        mesh.solve(p, body_dt);
        at += bodies.step;
        speed = bodies.step / body_dt;
        const float keep = std::exp(-40.0f * body_dt) / body_dt;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
            p.position[i] = p.predicted[i];
        }
    }
};

TEST(YieldingBodies, CarryTheTissuesWeight) {
    constexpr float g = 9.81f;
    for (const float stiffness : {5.0f, 500.0f, 50e3f}) {
        SprungBlock block({stiffness, 1e9f}, {1e-3f, 1e-6f}, {0.1f, 0.0f});
        const float deflection = -block.moving_mass() * g / stiffness;
        for (int n = 0; n < 1500; ++n) {
            block.step({0.0f, 0.0f, -g});
        }
        EXPECT_NEAR(block.at[0], deflection, 1e-3f * std::abs(deflection)) << stiffness << " N/m";
    }
}

// The wall yields with the body's own pace: tissue that lies on it does not hold it up.
TEST(YieldingBodies, WallsTheyCarryYieldAtTheirPace) {
    constexpr float g = 9.81f;
    constexpr float stiffness = 20.0f;  // [N/m], far less than that of the contacts; damped over 0.1 s
    SprungBlock block({stiffness, 1e9f}, {1e-3f, 1e-6f}, {2.0f, 0.0f}, Lowest::on_wall);
    const float deflection = -block.moving_mass() * g / stiffness;
    for (int n = 0; n < 90; ++n) {
        block.step({0.0f, 0.0f, -g});
    }
    EXPECT_NEAR(block.at[0], deflection, 0.05f * std::abs(deflection)) << "within half a second";
    for (int n = 0; n < 900; ++n) {
        block.step({0.0f, 0.0f, -g});
    }
    EXPECT_NEAR(block.at[0], deflection, 1e-3f * std::abs(deflection));
}

TEST(YieldingBodies, TurnUnderTheTissuesMoment) {
    constexpr float g = 9.81f;
    constexpr float stiffness = 2e-3f;  // [N m/rad]
    SprungBlock block({1e9f, stiffness}, {1e-3f, 1e-8f}, {0.0f, 1e-5f});
    for (int n = 0; n < 3000; ++n) {
        block.step({0.0f, 0.0f, -g});
    }
    float moment = 0.0f;
    for (std::size_t k = 0; k < block.mesh.particles().size(); ++k) {
        const float w = block.mesh.inverse_mass(k);
        const Vec3f& x = block.body.particles.position[block.mesh.particles()[k]];
        moment += w > 0.0f ? x.cross(Vec3f(0.0f, 0.0f, -g / w)).x() : 0.0f;
    }
    EXPECT_NEAR(block.at[1], moment / stiffness, 2e-3f * std::abs(moment / stiffness));
    EXPECT_LT(block.at[1], -0.01f);
}

// A partitioned exchange of forces between tissue and a body lighter than it diverges.
TEST(YieldingBodies, AreStableForAnyMassAndStiffness) {
    for (const float mass : {1e-9f, 1e-4f, 10.0f}) {
        for (const float stiffness : {1e-3f, 1.0f, 1e6f}) {
            SprungBlock block({stiffness, 1e9f}, {mass, 1e-6f}, {1e-3f, 0.0f});
            block.at[0] = 0.0f;
            for (std::size_t i = 0; i < block.body.particles.size(); ++i) {
                block.body.particles.velocity[i] = Vec3f(0.0f, 0.0f, 0.5f);
            }
            float farthest = 0.0f;
            for (int n = 0; n < 400; ++n) {
                block.step(Vec3f::Zero());
                farthest = std::max(farthest, std::abs(block.at[0]));
            }
            EXPECT_LT(farthest, 0.1f) << mass << " kg, " << stiffness << " N/m";
            EXPECT_LT(std::abs(block.speed[0]), 0.05f) << mass << " kg, " << stiffness << " N/m";
        }
    }
}

TEST(YieldingBodies, MoveTheHeldCornersAsTheirCoordinates) {
    SprungBlock block({50.0f, 1e9f}, {1e-3f, 1e-6f}, {0.1f, 0.0f});
    for (int n = 0; n < 100; ++n) {
        block.step({0.0f, 0.0f, -9.81f});
    }
    ASSERT_LT(block.at[0], -1e-6f);
    const Particles& p = block.body.particles;
    for (const std::uint32_t k : block.mesh.held()) {
        const std::uint32_t i = block.mesh.particles()[k];
        EXPECT_NEAR(p.position[i].z() - p.rest[i].z(), block.at[0], 1e-6f);
    }
}

TEST(YieldingBodies, TooStiffToMoveAreAsHeld) {
    const auto lowest_after = [](float stiffness) {
        SprungBlock block({stiffness, 1e9f}, {1e-3f, 1e-6f}, {0.0f, 0.0f});
        for (int n = 0; n < 300; ++n) {
            block.step({0.0f, 3.0f, 0.0f});
        }
        float farthest = 0.0f;
        for (std::size_t i = 0; i < block.body.particles.size(); ++i) {
            farthest = std::max(farthest, block.body.particles.position[i].y());
        }
        return farthest;
    };
    EXPECT_NEAR(lowest_after(1e7f), lowest_after(1e9f), 1e-7f);
}

}  // namespace
}  // namespace eti::pbd
