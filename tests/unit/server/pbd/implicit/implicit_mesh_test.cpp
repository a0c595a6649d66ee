// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/implicit_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/math/random.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/tetrahedral_body.hpp"
#include "tests/support/threads.hpp"

namespace eti::pbd {
namespace {

constexpr float implicit_dt = 1.0f / 180.0f;

/// A block of tissue, 8 kPa, advanced by one solve per step.
struct Block {
    test::TetrahedralBody body;
    ImplicitMesh mesh;

    explicit Block(test::TetrahedralLattice lattice, bool held = false)
        : body(std::move(lattice), 8e3f, 0.45f) {
        Particles& p = body.particles;
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            if (p.rest[i].z() < 1e-6f) {
                p.inverse_mass[i] = held ? 0.0f : p.inverse_mass[i];
            }
        }
        const std::vector<float> moduli(body.lattice.tetrahedra.size(), 8e3f);
        mesh.configure({{body.lattice.tetrahedra, moduli, 0.45f}, {}}, p, p.inverse_mass);
    }

    Particles& particles() { return body.particles; }

    void step(const Vec3f& gravity, float damping) {
        Particles& p = body.particles;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                p.velocity[i] += implicit_dt * gravity;
            }
            p.predicted[i] = p.position[i];
        }
        mesh.solve(p, implicit_dt);
        const float keep = std::exp(-damping * implicit_dt) / implicit_dt;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
            p.position[i] = p.predicted[i];
        }
    }
};

test::TetrahedralLattice small_block() {
    return test::tetrahedral_lattice(4, 4, 3, 2.5e-3);
}

void crumple(Particles& p, float by) {
    Random random(5);
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            p.position[i] += by * Vec3f(random.normal(), random.normal(), random.normal());
        }
    }
}

double farthest_from_rest(const Particles& p) {
    double most = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        most = std::max(most, static_cast<double>((p.position[i] - p.rest[i]).norm()));
    }
    return most;
}

TEST(ImplicitMesh, RestStateIsStationary) {
    // Elements compute strains from differences of coordinates of 1 cm in floats: 1e-9 m of a cell of 2.5 mm,
    // and a body of ten cells may lean by as much in each.
    Block block(small_block(), true);
    for (int k = 0; k < 200; ++k) {
        block.step(Vec3f::Zero(), 0.0f);
    }
    EXPECT_LT(farthest_from_rest(block.particles()), 1e-8);
}

TEST(ImplicitMesh, FreeFallMatchesImplicitEuler) {
    // Weight only: after n steps n (n + 1) / 2 g dt^2, once the iterations converge.
    Block block(small_block());
    block.mesh.settings.iterations = 200;
    const Vec3f gravity(0, 0, -9.81f);
    constexpr int steps = 30;
    for (int k = 0; k < steps; ++k) {
        block.step(gravity, 0.0f);
    }
    const double expected =
        -0.5 * steps * (steps + 1) * 9.81 * static_cast<double>(implicit_dt * implicit_dt);
    for (std::size_t i = 0; i < block.particles().size(); ++i) {
        EXPECT_NEAR(block.particles().position[i].z() - block.particles().rest[i].z(), expected, 1e-4);
    }
}

TEST(ImplicitMesh, CrumpledBlockRecovers) {
    // A third of a cell in each direction inverts many tetrahedra.
    Block block(small_block(), true);
    crumple(block.particles(), 0.8e-3f);
    for (int k = 0; k < 360; ++k) {
        block.step(Vec3f::Zero(), 12.0f);
    }
    EXPECT_LT(farthest_from_rest(block.particles()), 1e-4);  // a hundredth of the block
}

TEST(ImplicitMesh, LongBodyNeedsNoExtraIterations) {
    // A bar of 60 mm, held at one end and pulled at the other. An iteration propagates forces from neighbour
    // to neighbour, over 24 cells; with the particles' own blocks as preconditioner alone, eight of them
    // leave three quarters of the error.
    const auto pulled = [](int iterations) {
        Block bar(test::tetrahedral_lattice(4, 4, 24, 2.5e-3), true);
        bar.mesh.settings.iterations = iterations;
        Particles& p = bar.particles();
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.rest[i].z() > 59e-3f) {
                p.velocity[i] = Vec3f(0, 0, 0.5f);
            }
        }
        bar.step(Vec3f::Zero(), 0.0f);
        return p;
    };
    const Particles solved = pulled(400);
    const Particles found = pulled(8);
    double apart = 0.0;
    double way = 0.0;
    for (std::size_t i = 0; i < solved.size(); ++i) {
        apart += static_cast<double>((found.position[i] - solved.position[i]).squaredNorm());
        way += static_cast<double>((solved.position[i] - solved.rest[i]).squaredNorm());
    }
    EXPECT_LT(std::sqrt(apart / way), 0.1);
}

TEST(ImplicitMesh, EdgeContactActsAtBarycentricPoint) {
    // The impulse acts on the whole, and three quarters of its force on the near end. Converged conjugate
    // gradients keep the elements' forces in balance: 200 iterations for 100 particles.
    Block block(small_block());
    block.mesh.settings.iterations = 200;
    Particles& p = block.particles();
    const auto& corners = block.body.lattice.tetrahedra.front();
    MeshContact c;
    c.particle = {corners[0], corners[1]};
    c.share = {0.75f, 0.25f};
    c.corners = 2;
    c.normal = Vec3f::UnitX();
    c.gap = -1e-4f;
    block.mesh.contacts = {c};
    block.step(Vec3f::Zero(), 0.0f);
    Vec3d momentum = Vec3d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
        momentum += p.velocity[i].cast<double>() / static_cast<double>(p.inverse_mass[i]);
    }
    const double given = static_cast<double>(block.mesh.contacts.front().force.x() * implicit_dt);
    EXPECT_GT(given, 0.0);
    EXPECT_NEAR(momentum.x(), given, 1e-3 * given);
    const float near = p.position[corners[0]].x() - p.rest[corners[0]].x();
    const float far = p.position[corners[1]].x() - p.rest[corners[1]].x();
    EXPECT_GT(near, far);
}

/// Positions after violent motion.
std::vector<Vec3f> shaken(bool avx2) {
    Block block(test::tetrahedral_lattice(9, 8, 7, 2.5e-3), true);
    block.mesh.use_avx2(avx2);
    crumple(block.particles(), 0.5e-3f);
    for (int k = 0; k < 10; ++k) {
        block.step(Vec3f(1.0f, 0.0f, -9.81f), 12.0f);
    }
    return block.particles().position;
}

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

TEST(ImplicitMesh, SameBitsForAnyThreadsAndInstructionSet) {
    const std::vector<Vec3f> expected = test::with_threads(1, [] { return shaken(true); });
    for (const std::size_t threads : {2, 8}) {
        EXPECT_TRUE(same_bits(test::with_threads(threads, [] { return shaken(true); }), expected)) << threads;
    }
    EXPECT_TRUE(same_bits(shaken(false), expected));
}

TEST(ImplicitMesh, SolveDoesNotAllocate) {
    Block block(small_block(), true);
    block.step(Vec3f(0, 0, -9.81f), 12.0f);
    Particles& p = block.particles();
    p.predicted = p.position;
    test::with_threads(1, [&] {
        const long before = test::allocations_here();
        block.mesh.solve(p, implicit_dt);
        EXPECT_EQ(test::allocations_here(), before);
    });
}

}  // namespace
}  // namespace eti::pbd
