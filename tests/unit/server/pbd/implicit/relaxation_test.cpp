// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/relaxation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include "common/math/random.hpp"
#include "server/pbd/implicit/hexahedron_kernels.hpp"
#include "server/pbd/implicit/tetrahedron_kernels.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/hexahedral_block.hpp"
#include "tests/support/tetrahedral_body.hpp"
#include "tests/support/threads.hpp"

namespace eti::pbd {
namespace {

using test::cell_edge;
using test::cell_modulus;
using test::HexahedralBlock;

constexpr Relaxation law{.share = 0.4f, .time = 3.0f};
constexpr double share = 0.4, time_constant = 3.0;
constexpr double nu = 0.49;
constexpr double shear = cell_modulus / (2.0 * (1.0 + nu));  // [Pa]

/// mu(t) / mu
double modulus_after(double time) {
    return 1.0 - share + share * std::exp(-time / time_constant);
}

Eigen::Matrix3d simple_shear(double gamma) {
    Eigen::Matrix3d out = Eigen::Matrix3d::Identity();
    out(0, 1) = gamma;
    return out;
}

/// One cube, as a hexahedron or as five tetrahedra, whose corners are put where a test wants them.
template <class Elements>
struct Cube {
    static constexpr bool whole = std::is_same_v<Elements, Hexahedra>;
    static constexpr std::size_t most_blocks = 5;
    using Element = std::conditional_t<whole, ImplicitMesh::HexahedronElement, ImplicitMesh::Element>;
    using Corners = std::array<Vec3d, 8>;

    Particles particles;
    Hexahedra hexahedra;
    Tetrahedra tetrahedra;
    RelaxationMemory memory;
    std::vector<std::uint32_t> corner_of;

    explicit Cube(const Relaxation& relaxation = law) {
        particles.resize(8);
        for (std::uint32_t v = 0; v < 8; ++v) {
            particles.rest[v] = rest()[v].template cast<float>();
        }
        CornerNumbering numbering(8);
        const auto modulus = static_cast<float>(cell_modulus);
        if constexpr (whole) {
            Hexahedra::Description description{{{0, 1, 2, 3, 4, 5, 6, 7}}, {modulus}, static_cast<float>(nu)};
            numbering.add(description.hexahedra, spatial_order(description.hexahedra, particles.rest));
            hexahedra.configure(description, particles, numbering);
        } else {
            Tetrahedra::Description description{
                {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}},
                std::vector<float>(5, modulus),
                static_cast<float>(nu)};
            numbering.add(description.tetrahedra, spatial_order(description.tetrahedra, particles.rest));
            tetrahedra.configure(description, particles, numbering);
        }
        for (std::uint32_t v = 0; v < 8; ++v) {
            corner_of.push_back(numbering[v]);
        }
        memory.configure(relaxation, tetrahedra, hexahedra);
    }
    static Corners rest() {
        Corners out;
        for (unsigned v = 0; v < 8; ++v) {
            out[v] = cell_edge * Vec3d(v & 1u, v >> 1 & 1u, v >> 2 & 1u);
        }
        return out;
    }
    static Corners mapped(const Eigen::Matrix3d& by, const Corners& corners = rest()) {
        Corners out;
        for (std::size_t v = 0; v < 8; ++v) {
            out[v] = by * corners[v];
        }
        return out;
    }

    /// Forces of the elements on the corners [N] at a step's begin, after which it lasts `dt` [s].
    Corners forces(const Corners& at, double dt) {
        const std::size_t padded = 8 + 64;
        std::vector<Eigen::Vector4f> x(padded, Eigen::Vector4f::Zero());
        for (std::size_t v = 0; v < 8; ++v) {
            x[corner_of[v]].template head<3>() = at[v].template cast<float>();
        }
        std::vector<Eigen::Vector4f> sums[3];
        for (auto& sum : sums) {
            sum.assign(padded, Eigen::Vector4f::Zero());
        }
        const ImplicitSums to{sums[0].front().data(), sums[1].front().data(), sums[2].front().data()};
        const RelaxationStep step = memory.step(static_cast<float>(dt));
        const auto ratio = static_cast<float>(1.0 - 2.0 * nu);
        std::array<Element, most_blocks> element;
        if constexpr (whole) {
            relaxing = linearise_hexahedra(hexahedra.blocks().data(), element.data(), 1, x.front().data(), to,
                                           ratio, 0.0f, step, memory.hexahedra());
        } else {
            relaxing =
                linearise_blocks(tetrahedra.blocks().data(), element.data(), tetrahedra.blocks().size(),
                                 x.front().data(), to, ratio, step, memory.tetrahedra());
        }
        Corners out;
        for (std::size_t v = 0; v < 8; ++v) {
            out[v] = -sums[0][corner_of[v]].template head<3>().template cast<double>();
        }
        return out;
    }
    bool relaxing = false;

    /// Force [N] along x on the upper face (y) that holds it.
    double shear_force(const Corners& at, double dt) {
        double sum = 0.0;
        const Corners by_elements = forces(at, dt);
        for (unsigned v = 0; v < 8; ++v) {
            sum -= (v & 2u) != 0 ? by_elements[v].x() : 0.0;
        }
        return sum;
    }
};

template <class Elements>
class RelaxationTest : public ::testing::Test {};
using Kinds = ::testing::Types<Hexahedra, Tetrahedra>;
TYPED_TEST_SUITE(RelaxationTest, Kinds);

// Simple shear, whose stress is mu gamma at any strain. The memory follows the shape at a step's begin, so
// that the shape appears in it a step after. Floats round stresses, among them pressures 50 times as stiff.
TYPED_TEST(RelaxationTest, HeldShearMatchesClosedForm) {
    for (const double gamma : {0.05, 0.6}) {
        const double sudden = shear * gamma * cell_edge * cell_edge;
        for (const double dt : {1.0 / 720.0, 1.0 / 180.0, 0.1, 1.0}) {
            Cube<TypeParam> cube;
            const auto held = cube.mapped(simple_shear(gamma));
            for (int k = 0; k * dt < 12.0; ++k) {
                const double expected = sudden * modulus_after((k + 1) * dt);
                ASSERT_NEAR(cube.shear_force(held, dt), expected, 1e-4 * sudden) << gamma << ' ' << k * dt;
            }
        }
    }
}

// Uniaxial stretch at constant volume: what relaxes is the difference of normal stresses, mu (a^2 - 1 / a).
TYPED_TEST(RelaxationTest, HeldStretchMatchesClosedForm) {
    for (const double stretch : {0.6, 1.5}) {
        Cube<TypeParam> cube;
        Eigen::Matrix3d by = Eigen::Vector3d::Constant(1.0 / std::sqrt(stretch)).asDiagonal();
        by(0, 0) = stretch;
        const auto held = cube.mapped(by);
        const double sudden = shear * (stretch * stretch - 1.0 / stretch);
        constexpr double dt = 1.0 / 180.0;
        for (int k = 0; k < 2000; ++k) {
            const auto forces = cube.forces(held, dt);
            Vec3d normal = Vec3d::Zero();  // Cauchy stresses from forces on faces
            for (unsigned v = 0; v < 8; ++v) {
                for (int axis = 0; axis < 3; ++axis) {
                    const bool high = (v >> axis & 1u) != 0;
                    const double area = cell_edge * cell_edge / by(axis, axis);
                    normal[axis] -= high ? forces[v][axis] / area : 0.0;
                }
            }
            ASSERT_NEAR(normal.x() - normal.y(), sudden * modulus_after((k + 1) * dt),
                        2e-4 * std::fabs(sudden));
        }
    }
}

// In oscillating shear a standard linear solid dissipates pi G'' gamma^2 per volume and cycle, with the loss
// modulus G'' = mu share w / (1 + w^2), w the product of angular frequency and time constant.
TYPED_TEST(RelaxationTest, CycleDissipatesByTheLossModulus) {
    constexpr double gamma = 0.4;
    constexpr int per_cycle = 8000;
    for (const double w : {0.3, 1.0, 4.0}) {
        Cube<TypeParam> cube;
        const double dt = 2.0 * std::numbers::pi * time_constant / w / per_cycle;
        double work = 0.0;
        double last_force = 0.0;
        double last_way = 0.0;
        for (int k = 0; k <= 6 * per_cycle; ++k) {  // the last of them, when the start is forgotten
            const double strain = gamma * std::sin(2.0 * std::numbers::pi * k / per_cycle);
            const double force = cube.shear_force(cube.mapped(simple_shear(strain)), dt);
            const double way = strain * cell_edge;
            work += k > 5 * per_cycle ? 0.5 * (force + last_force) * (way - last_way) : 0.0;
            last_force = force;
            last_way = way;
        }
        const double loss = shear * share * w / (1.0 + w * w);
        const double expected = std::numbers::pi * loss * gamma * gamma * std::pow(cell_edge, 3);
        EXPECT_NEAR(work, expected, 3e-3 * expected) << w;
    }
}

// The same history, and the same with the cell turned meanwhile.
TYPED_TEST(RelaxationTest, StressTurnsWithTheCell) {
    Cube<TypeParam> cube;
    Cube<TypeParam> turned;
    Eigen::Matrix3d strain;
    strain << 1.2, 0.3, 0.0, 0.1, 0.9, -0.2, 0.0, 0.25, 1.0;
    const auto held = cube.mapped(strain);
    constexpr double dt = 0.05;
    for (int k = 0; k < 60; ++k) {
        const Eigen::Matrix3d turn =
            Eigen::AngleAxisd(0.1 * k, Vec3d(1.0, 2.0, -2.0).normalized()).toRotationMatrix();
        const auto expected = cube.mapped(turn, cube.forces(held, dt));
        const auto found = turned.forces(turned.mapped(turn, held), dt);
        for (std::size_t v = 0; v < 8; ++v) {
            ASSERT_LT((found[v] - expected[v]).norm(), 2e-4 * shear * cell_edge * cell_edge) << k;
        }
    }
}

// A cell that a hand has crumpled, turned inside out or flattened keeps a bounded memory, and forgets it.
TYPED_TEST(RelaxationTest, CrushedCellRecovers) {
    for (const double squeezed : {0.3, 0.05, 0.0, -0.3}) {
        Cube<TypeParam> cube;
        Eigen::Matrix3d by = Eigen::Matrix3d::Identity();
        by(2, 2) = squeezed;
        for (int k = 0; k < 2000; ++k) {
            const auto forces = cube.forces(cube.mapped(by), 1.0 / 180.0);
            ASSERT_TRUE(std::isfinite(forces[0].sum())) << squeezed;
        }
        for (const RelaxedMetric& metric : cube.memory.metrics()) {
            for (const auto& lanes : metric.metric) {
                for (const float value : lanes) {
                    // M is a few per edge squared.
                    ASSERT_LE(std::fabs(value), 100.0f / static_cast<float>(cell_edge * cell_edge));
                }
            }
        }
        for (int k = 0; k < 200; ++k) {
            (void)cube.forces(cube.rest(), 0.25);
        }
        EXPECT_LT(std::fabs(cube.shear_force(cube.rest(), 0.25)), 1e-4 * shear * cell_edge * cell_edge);
        EXPECT_FALSE(cube.relaxing);
    }
}

TYPED_TEST(RelaxationTest, ResetForgets) {
    Cube<TypeParam> cube;
    Cube<TypeParam> fresh;
    const auto held = cube.mapped(simple_shear(0.5));
    for (int k = 0; k < 300; ++k) {
        (void)cube.forces(held, 0.01);
    }
    EXPECT_TRUE(cube.relaxing);
    cube.memory.reset(cube.tetrahedra, cube.hexahedra);
    EXPECT_EQ(cube.forces(held, 0.01), fresh.forces(held, 0.01));
}

TYPED_TEST(RelaxationTest, RecoveringForgetsWithinHalfASecond) {
    Cube<TypeParam> cube;
    Cube<TypeParam> fresh;
    const auto held = cube.mapped(simple_shear(0.5));
    for (int k = 0; k < 300; ++k) {
        (void)cube.forces(held, 0.05);
    }
    cube.memory.set_recovering(true);
    for (int k = 0; k < 90; ++k) {
        (void)cube.forces(held, 1.0 / 180.0);
    }
    const double sudden = fresh.shear_force(held, 0.0);
    EXPECT_NEAR(cube.shear_force(held, 0.0), sudden, 1e-3 * sudden);
}

// A posture turns and stretches rest shapes: a memory turns along, and without one none arises.
TYPED_TEST(RelaxationTest, MemoryFollowsTheRestShape) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3d(1.0, 2.0, -2.0).normalized()).matrix();
    Eigen::Matrix3d stretch;
    stretch << 1.3, 0.1, 0.0, 0.1, 0.8, 0.05, 0.0, 0.05, 1.1;
    const auto adopt = [](Cube<TypeParam>& cube, const Eigen::Matrix3d& by) {
        for (std::uint32_t v = 0; v < 8; ++v) {
            cube.particles.rest[v] = (by * cube.rest()[v]).template cast<float>();
        }
        cube.memory.begin_rest(cube.tetrahedra, cube.hexahedra);
        if (Cube<TypeParam>::whole) {
            cube.hexahedra.set_rest(cube.particles);
        } else {
            cube.tetrahedra.set_rest(cube.particles);
        }
        cube.memory.end_rest(cube.tetrahedra, cube.hexahedra);
    };
    const double scale = shear * cell_edge * cell_edge;
    Cube<TypeParam> still;
    adopt(still, turn * stretch);
    for (const Vec3d& force : still.forces(still.mapped(turn * stretch), 0.0)) {
        EXPECT_LT(force.norm(), 5e-4 * scale);  // rounding of volumes, times 50
    }
    Cube<TypeParam> cube;
    Cube<TypeParam> turned;
    const auto held = cube.mapped(simple_shear(0.5));
    for (int k = 0; k < 300; ++k) {
        (void)cube.forces(held, 0.01);
        (void)turned.forces(held, 0.01);
    }
    adopt(turned, turn);
    const auto expected = cube.mapped(turn, cube.forces(held, 0.0));
    const auto found = turned.forces(turned.mapped(turn, held), 0.0);
    for (std::size_t v = 0; v < 8; ++v) {
        EXPECT_LT((found[v] - expected[v]).norm(), 2e-4 * scale);
    }
}

/// Pulls the top of a block with springs of this stiffness [N/m] to points `way` [m] from rest.
void pull_top(HexahedralBlock& block, float stiffness, const Vec3f& way) {
    block.mesh.springs.clear();
    const float top = block.particles.rest.back().z();
    for (std::uint32_t i = 0; i < block.particles.size(); ++i) {
        if (block.particles.rest[i].z() > top - 1e-6f) {
            block.mesh.springs.push_back({i, block.particles.rest[i] + way, stiffness});
        }
    }
}

/// Mean force of these springs along x [N].
double force_of_springs(const HexahedralBlock& block) {
    double sum = 0.0;
    for (const ImplicitMesh::Spring& spring : block.mesh.springs) {
        const Vec3f& x = block.particles.position[spring.particle];
        sum += static_cast<double>(spring.stiffness * (spring.to - x).x());
    }
    return sum / static_cast<double>(block.mesh.springs.size());
}

// Of a nearly incompressible, slightly strained block every stiffness is proportional to mu(t), so that the
// force of its held top falls with mu(t). 2 %: the springs that hold give way by about as much less.
TEST(RelaxingMesh, HeldBlockMatchesClosedForm) {
    for (const float dt : {1.0f / 180.0f, 1.0f / 60.0f}) {
        HexahedralBlock block(4, 4, 4, nu, true);
        block.mesh.relax(law);
        pull_top(block, 100.0f, {0.4e-3f, 0.0f, 0.0f});
        const auto run = [&](double until, double from) {
            for (int k = 0; k < std::lround((until - from) / static_cast<double>(dt)); ++k) {
                block.step(Vec3f::Zero(), dt);
            }
        };
        run(0.2, 0.0);
        const double first = force_of_springs(block);
        double last = 0.2;
        for (const double time : {1.2, 4.2, 9.2}) {
            run(time, last);
            last = time;
            EXPECT_NEAR(force_of_springs(block) / first, modulus_after(time) / modulus_after(0.2), 0.02)
                << time;
        }
        EXPECT_TRUE(block.mesh.is_relaxing());
    }
}

TEST(RelaxingMesh, CrumpledBlockRecovers) {
    HexahedralBlock block(4, 4, 3, nu, true);
    block.mesh.relax({.share = 0.4f, .time = 0.2f});
    Random random(5);
    for (std::size_t i = 0; i < block.particles.size(); ++i) {
        if (block.particles.inverse_mass[i] > 0.0f) {
            block.particles.position[i] += 0.8e-3f * Vec3f(random.normal(), random.normal(), random.normal());
        }
    }
    for (int k = 0; k < 1440; ++k) {
        block.step();
    }
    EXPECT_LT(block.farthest_from_rest(), 1e-5);
    EXPECT_FALSE(block.mesh.is_relaxing());
}

TEST(RelaxingMesh, RestStateIsStationary) {
    HexahedralBlock block(4, 4, 3, nu, true);
    block.mesh.relax(law);
    for (int k = 0; k < 200; ++k) {
        block.step();
        ASSERT_FALSE(block.mesh.is_relaxing());
    }
    EXPECT_LT(block.farthest_from_rest(), 1e-7);  // float rounding of strains, times 50
}

TEST(RelaxingMesh, SameBitsForAnyThreadsAndInstructions) {
    const auto run = [](std::size_t threads, bool avx2) {
        return test::with_threads(threads, [&] {
            HexahedralBlock block(5, 4, 3, nu, true);
            block.mesh.relax({.share = 0.4f, .time = 0.05f});
            block.mesh.use_avx2(avx2 && has_avx2());
            for (int k = 0; k < 40; ++k) {
                block.step({3.0f, 0.0f, 20.0f});
            }
            return block.particles.position;
        });
    };
    const std::vector<Vec3f> expected = run(1, false);
    EXPECT_EQ(run(1, true), expected);
    EXPECT_EQ(run(3, true), expected);
}

TEST(RelaxingMesh, StepDoesNotAllocate) {
    HexahedralBlock block(4, 4, 3, nu, true);
    block.mesh.relax(law);
    block.step();
    const long before = test::allocations_here();
    block.mesh.set_rest(block.particles);
    block.step();
    EXPECT_EQ(test::allocations_here(), before);
}

}  // namespace
}  // namespace eti::pbd
