// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/cluster_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "server/pbd/soft/soft_body.hpp"

namespace eti::pbd {
namespace {

constexpr float density = 4000.0f;

/// A flat plate of particles on a lattice: its length along x, in strips of whole layers, across y, thick in
/// z. The first strip may be held.
struct Plate {
    int layers = 3;  // per strip
    int across = 9, thick = 2;
    float spacing = 1e-3f;
    float modulus = 320e3f;
    int strips = 5;
    float dt = 1.0f / 1440.0f;

    [[nodiscard]] float mass() const { return density * spacing * spacing * spacing; }
    [[nodiscard]] int along() const { return layers * strips; }
    [[nodiscard]] std::uint32_t layer_of(std::uint32_t particle) const {
        return particle / static_cast<std::uint32_t>(across * thick);
    }

    [[nodiscard]] SoftBody body(bool held) const {
        SoftBody body;
        Particles& p = body.particles;
        const auto count = static_cast<std::size_t>(along() * across * thick);
        p.resize(count);
        ClusterChain::Description chain;
        chain.youngs_modulus = modulus;
        chain.across = Vec3f::UnitY();
        chain.clusters.resize(static_cast<std::size_t>(strips));
        std::uint32_t i = 0;
        for (int x = 0; x < along(); ++x) {
            for (int y = 0; y < across; ++y) {
                for (int z = 0; z < thick; ++z, ++i) {
                    p.rest[i] =
                        spacing * Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                    p.inverse_mass[i] = held && x < layers ? 0.0f : 1.0f / mass();
                    chain.clusters[static_cast<std::size_t>(x / layers)].push_back(i);
                }
            }
        }
        chain.fitting_mass.assign(count, mass());
        chain.volume.assign(count, spacing * spacing * spacing);
        ShapeMatching::Description shapes;
        shapes.particle_volume = chain.volume;
        shapes.fitting_mass = chain.fitting_mass;
        shapes.first.push_back(0);
        for (const auto& members : chain.clusters) {
            shapes.member.insert(shapes.member.end(), members.begin(), members.end());
            shapes.first.push_back(static_cast<std::uint32_t>(shapes.member.size()));
            shapes.youngs_modulus.push_back(modulus);
        }
        body.shapes.configure(shapes, p);
        ClusterChain joined;
        joined.configure(chain, p);
        body.constraints.emplace_back(std::move(joined));
        body.reset();
        return body;
    }

    /// Sag [m] of the free end under `force` [N], distributed over its last layer.
    [[nodiscard]] float sag(float force) const {
        SoftBody body = this->body(true);
        body.settings.damping = 60.0f;  // [1/s], about the rate of its slowest wave
        Particles& p = body.particles;
        std::vector<std::size_t> loaded;
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            if (layer_of(i) == static_cast<std::uint32_t>(along() - 1)) {
                loaded.push_back(i);
            }
        }
        const float push = force / static_cast<float>(loaded.size()) * dt / mass();
        for (float time = 0.0f; time < 2.0f; time += dt) {
            for (const std::size_t i : loaded) {
                p.velocity[i].z() -= push;
            }
            substep(body);
        }
        float sunk = 0.0f;
        for (const std::size_t i : loaded) {
            sunk += (p.rest[i].z() - p.position[i].z()) / static_cast<float>(loaded.size());
        }
        return sunk;
    }

    void substep(SoftBody& body) const {
        body.predict(dt, 1.0f);
        body.project(dt);
        body.finish(dt);
    }

    /// F L^3 / (3 E I): strips are rigid, so the held one acts as clamped at its middle.
    [[nodiscard]] float of_beam(float force) const {
        const float length =
            static_cast<float>(along() - 1) * spacing - 0.5f * static_cast<float>(layers - 1) * spacing;
        const float thickness = static_cast<float>(thick) * spacing;
        const float second_moment =
            static_cast<float>(across) * spacing * thickness * thickness * thickness / 12.0f;
        return force * length * length * length / (3.0f * modulus * second_moment);
    }
};

class ClusterChainBending : public testing::TestWithParam<Plate> {};

// Four joints approximate a continuously bending beam: sums over joints instead of integrals are within 2 %
// of it, and the load is offset from the last strip's middle, which is rigid.
TEST_P(ClusterChainBending, MatchesBeamTheory) {
    const Plate plate = GetParam();
    const float length = static_cast<float>(plate.along()) * plate.spacing;
    const float force = 0.03f * length / plate.of_beam(1.0f);  // small against its length
    EXPECT_NEAR(plate.sag(force), plate.of_beam(force), 0.1f * plate.of_beam(force));
}

INSTANTIATE_TEST_SUITE_P(Plates, ClusterChainBending,
                         testing::Values(Plate{}, Plate{.spacing = 0.68e-3f}, Plate{.modulus = 32e3f},
                                         Plate{.modulus = 3200e3f}, Plate{.thick = 3},
                                         Plate{.layers = 2, .spacing = 1.25e-3f},
                                         Plate{.layers = 4, .spacing = 0.8e-3f}, Plate{.dt = 1.0f / 720.0f},
                                         Plate{.dt = 1.0f / 5760.0f}));

TEST(ClusterChain, ConservesLinearAndAngularMomentum) {
    const Plate plate;
    SoftBody body = plate.body(false);
    Particles& p = body.particles;
    // Strips displaced by up to a fifth of their length, and rotated.
    std::mt19937 random(7);
    std::uniform_real_distribution<float> way(-1.0f, 1.0f);
    for (std::uint32_t first = 0; first < p.size(); first += 54) {
        const Vec3f axis(way(random), way(random), way(random));
        const Vec3f shift = 0.6e-3f * Vec3f(way(random), way(random), way(random));
        const Eigen::AngleAxisf turn(0.2f, axis.normalized());
        for (std::uint32_t i = first; i < first + 54; ++i) {
            p.predicted[i] = p.rest[first] + shift + turn * (p.rest[i] - p.rest[first]);
        }
    }
    const std::vector<Vec3f> before = p.predicted;
    (*body.constraints.front()).project(p, plate.dt);
    Vec3d linear = Vec3d::Zero();
    Vec3d angular = Vec3d::Zero();
    double most = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3d moved = (p.predicted[i] - before[i]).cast<double>();
        most = std::max(most, moved.norm());
        linear += moved / static_cast<double>(p.size());
        angular += before[i].cast<double>().cross(moved) / static_cast<double>(p.size());
    }
    ASSERT_GT(most, 0.2e-3);
    EXPECT_LT(linear.norm(), 1e-8) << "positions are floats of up to 15 mm";
    // Both sides of a joint meet at their actual positions, a few tenths of a millimetre apart.
    EXPECT_LT(angular.norm(), 0.02 * most * 5e-3);
}

TEST(ClusterChain, RecoversFromAnyBend) {
    const Plate plate;
    for (const Vec3f& axis : {Vec3f(Vec3f::UnitX()), Vec3f(Vec3f::UnitY()), Vec3f(Vec3f::UnitZ())}) {
        SoftBody body = plate.body(true);
        body.settings.damping = 60.0f;
        Particles& p = body.particles;
        // Rolled up by 2.4 rad from strip to strip, 0.6 each.
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            const auto strip = static_cast<float>(plate.layer_of(i) / 3);
            p.position[i] = Eigen::AngleAxisf(0.6f * strip, axis) * p.rest[i];
        }
        for (float time = 0.0f; time < 2.0f; time += plate.dt) {
            plate.substep(body);
        }
        for (std::size_t i = 0; i < p.size(); ++i) {
            ASSERT_LT((p.position[i] - p.rest[i]).norm(), 5e-6f)
                << "axis " << axis.transpose() << ", particle " << i;
        }
    }
}

TEST(ClusterChain, UnbentChainStaysAtRest) {
    const Plate plate;
    SoftBody body = plate.body(true);
    for (int step = 0; step < 200; ++step) {
        plate.substep(body);
    }
    for (std::size_t i = 0; i < body.particles.size(); ++i) {
        ASSERT_LT((body.particles.position[i] - body.particles.rest[i]).norm(), 1e-7f);
    }
}

}  // namespace
}  // namespace eti::pbd
