// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/hexahedra.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>

#include "common/math/random.hpp"
#include "server/pbd/implicit/hexahedron_kernels.hpp"
#include "server/pbd/implicit/implicit_mesh.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/hexahedral_block.hpp"
#include "tests/support/threads.hpp"

namespace eti::pbd {
namespace {

using Cell = std::array<Vec3d, 8>;

using test::cell_edge;
using test::cell_modulus;

/// Position, by reference coordinates from -1 to 1, and its derivatives.
Eigen::Matrix3d jacobian(const Cell& cell, const Vec3d& at) {
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    for (unsigned v = 0; v < 8; ++v) {
        const Vec3d sign((v & 1u) != 0 ? 1 : -1, (v & 2u) != 0 ? 1 : -1, (v & 4u) != 0 ? 1 : -1);
        const Vec3d one = Vec3d::Ones() + sign.cwiseProduct(at);
        const Vec3d slope(sign.x() * one.y() * one.z(), sign.y() * one.x() * one.z(),
                          sign.z() * one.x() * one.y());
        out += cell[v] * slope.transpose() / 8.0;
    }
    return out;
}

/// Mean over the cell by 3 x 3 x 3 Gauss points, exact for what is integrated here.
double mean_over(const std::function<double(const Vec3d&)>& value) {
    const double far = std::sqrt(0.6);
    const std::array<double, 3> place = {-far, 0.0, far};
    const std::array<double, 3> weight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    double sum = 0.0;
    for (std::size_t n = 0; n < 27; ++n) {
        const std::size_t i = n % 3;
        const std::size_t j = n / 3 % 3;
        const std::size_t k = n / 9;
        sum += weight[i] * weight[j] * weight[k] * value({place[i], place[j], place[k]});
    }
    return sum;
}

/// The element's energy [J] by quadrature of its definition; see hexahedron_kernels.hpp.
double energy(const Cell& rest, const Cell& cell, double ratio, double hardening) {
    const double mu = cell_modulus * ratio;  // any shear modulus
    const Eigen::Matrix3d to_rest = jacobian(rest, Vec3d::Zero()).inverse();
    const double volume = 8.0 * std::fabs(jacobian(rest, Vec3d::Zero()).determinant());
    const auto local = [&](const Vec3d& at) { return (jacobian(cell, at) * to_rest).determinant(); };
    const Eigen::Matrix3d mean = jacobian(cell, Vec3d::Zero()) * to_rest;
    const double shear =
        mean_over([&](const Vec3d& at) { return (jacobian(cell, at) * to_rest).squaredNorm(); });
    const double hourglass = shear - mean.squaredNorm();
    const double gamma = 1.0 + ratio;
    const double lost = mean_over(local) - gamma;
    double slopes = 0.0;
    constexpr double step = 1e-4;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d by = step * Vec3d::Unit(axis);
        slopes += std::pow((local(by) - local(-by)) / (2.0 * step), 2);
    }
    return mu * volume / 2.0 *
           (mean.squaredNorm() - 3.0 + hourglass + 0.5 * hardening * hourglass * hourglass +
            lost * lost / ratio + double{volume_gradient_stiffness} * slopes / 3.0);
}

Cell parallelepiped() {
    const Vec3d a(cell_edge, 0.1 * cell_edge, 0.0);
    const Vec3d b(-0.2 * cell_edge, 0.9 * cell_edge, 0.1 * cell_edge);
    const Vec3d c(0.1 * cell_edge, 0.0, 1.2 * cell_edge);
    Cell cell;
    for (unsigned v = 0; v < 8; ++v) {
        cell[v] = ((v & 1u) != 0 ? a : Vec3d(Vec3d::Zero())) + ((v & 2u) != 0 ? b : Vec3d(Vec3d::Zero())) +
                  ((v & 4u) != 0 ? c : Vec3d(Vec3d::Zero()));
    }
    return cell;
}

/// One cell in the first lane of a block, and its forces from the kernel.
struct SingleCell {
    Particles particles;
    Hexahedra hexahedra;
    double ratio;

    SingleCell(const Cell& rest, double poisson_ratio) : ratio(1.0 - 2.0 * poisson_ratio) {
        particles.resize(8);
        Hexahedra::Description description;
        Hexahedra::Corners corners{};
        for (std::uint32_t v = 0; v < 8; ++v) {
            particles.rest[v] = rest[v].cast<float>();
            corners[v] = v;
        }
        description.hexahedra = {corners};
        // Gives the shear modulus of energy().
        description.youngs_modulus = {static_cast<float>(cell_modulus * ratio * 2.0 * (1.0 + poisson_ratio))};
        description.poisson_ratio = static_cast<float>(poisson_ratio);
        CornerNumbering numbering(8);
        numbering.add(description.hexahedra, spatial_order(description.hexahedra, particles.rest));
        hexahedra.configure(description, particles, numbering);
    }

    [[nodiscard]] std::array<Vec3d, 8> gradient(const Cell& cell, float hardening) const {
        constexpr std::size_t padded = 8 + 64;
        std::vector<Eigen::Vector4f> x(padded, Eigen::Vector4f::Zero());
        for (std::size_t v = 0; v < 8; ++v) {
            x[v].head<3>() = cell[v].cast<float>();
        }
        std::vector<Eigen::Vector4f> sums[3];
        for (auto& sum : sums) {
            sum.assign(padded, Eigen::Vector4f::Zero());
        }
        ImplicitMesh::HexahedronElement element;
        linearise_hexahedra(hexahedra.blocks(0).data(), &element, 1, x.front().data(),
                            {sums[0].front().data(), sums[1].front().data(), sums[2].front().data()},
                            static_cast<float>(ratio), hardening);
        std::array<Vec3d, 8> out;
        for (std::size_t v = 0; v < 8; ++v) {
            out[v] = sums[0][v].head<3>().cast<double>();
        }
        return out;
    }
};

Cell deformed(const Cell& rest, unsigned seed) {
    Random random(seed);
    Cell cell = rest;
    for (Vec3d& x : cell) {
        x += 0.15 * cell_edge *
             Vec3d(double{random.normal()}, double{random.normal()}, double{random.normal()});
    }
    return cell;
}

// Central differences of an energy of 1e-7 J over steps of 1e-7 m in doubles; the kernel's floats round
// strains of order one by 1e-7, which pressure multiplies by 1 / (1 - 2 nu) = 50.
TEST(Hexahedra, ForceIsDerivativeOfEnergy) {
    const Cell rest = parallelepiped();
    for (const double nu : {0.3, 0.45, 0.49}) {
        for (const float hardening : {0.0f, 20.0f}) {
            const SingleCell single(rest, nu);
            const Cell cell = deformed(rest, 3);
            const std::array<Vec3d, 8> claimed = single.gradient(cell, hardening);
            double error = 0.0;
            double size = 0.0;
            for (std::size_t v = 0; v < 8; ++v) {
                for (int axis = 0; axis < 3; ++axis) {
                    constexpr double step = 1e-7;
                    Cell up = cell;
                    Cell down = cell;
                    up[v][axis] += step;
                    down[v][axis] -= step;
                    const double expected = (energy(rest, up, single.ratio, double{hardening}) -
                                             energy(rest, down, single.ratio, double{hardening})) /
                                            (2.0 * step);
                    error += std::pow(claimed[v][axis] - expected, 2);
                    size += expected * expected;
                }
            }
            EXPECT_LT(std::sqrt(error / size), 1e-4) << nu << ' ' << hardening;
        }
    }
}

TEST(Hexahedra, CornerForcesSumToZero) {
    const Cell rest = parallelepiped();
    const SingleCell single(rest, 0.49);
    Vec3d sum = Vec3d::Zero();
    double size = 0.0;
    for (const Vec3d& force : single.gradient(deformed(rest, 7), 20.0f)) {
        sum += force;
        size += force.norm();
    }
    EXPECT_LT(sum.norm(), 1e-5 * size);
}

using test::HexahedralBlock;

TEST(HexahedralMesh, RestStateIsStationary) {
    HexahedralBlock block(4, 4, 3, 0.49, true);
    for (int k = 0; k < 200; ++k) {
        block.step();
    }
    EXPECT_LT(block.farthest_from_rest(), 1e-7);  // float rounding of strains, times 50
}

TEST(HexahedralMesh, CrumpledBlockRecovers) {
    for (const double nu : {0.45, 0.49}) {
        HexahedralBlock block(4, 4, 3, nu, true);
        Random random(5);
        for (std::size_t i = 0; i < block.particles.size(); ++i) {
            if (block.particles.inverse_mass[i] > 0.0f) {
                block.particles.position[i] +=
                    0.8e-3f * Vec3f(random.normal(), random.normal(), random.normal());
            }
        }
        for (int k = 0; k < 720; ++k) {
            block.step();
        }
        EXPECT_LT(block.farthest_from_rest(), 1e-5) << nu;
    }
}

/// The volume ratio that three edges from a corner of a cube span.
double corner_volume(const Cell& cell, unsigned v) {
    Eigen::Matrix3d edges;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned bit = 1u << axis;
        edges.col(axis) = ((v & bit) != 0 ? -1.0 : 1.0) * (cell[v ^ bit] - cell[v]) / cell_edge;
    }
    return edges.determinant();
}

// A cube held at seven corners, and a spring that draws the eighth to the middle and beyond. At rest the
// spring bears the derivative of the energies of cell and corners.
TEST(HexahedralMesh, CrushedCornerBearsDerivativeOfEnergy) {
    constexpr double nu = 0.49;
    constexpr double mu = cell_modulus / (2.0 * (1.0 + nu));
    for (const float threshold : {0.4f, -100.0f}) {
        HexahedralBlock block(1, 1, 1, nu, false);
        block.mesh.settings.crushed_corner = threshold;
        std::vector<float> inverse_mass(8, 0.0f);
        inverse_mass[7] = block.particles.inverse_mass[7];
        ImplicitMesh::Description cube;
        cube.hexahedra = {{{0, 1, 2, 3, 4, 5, 6, 7}}, {static_cast<float>(cell_modulus)}, 0.49f};
        block.particles.inverse_mass = inverse_mass;
        block.mesh.configure(cube, block.particles, inverse_mass);
        const Vec3f to = 0.1f * block.particles.rest[7];
        constexpr float spring = 40.0f;
        block.mesh.springs = {{7, to, spring}};
        for (int k = 0; k < 2000; ++k) {
            block.step();
        }
        Cell rest;
        Cell cell;
        for (std::size_t v = 0; v < 8; ++v) {
            rest[v] = block.particles.rest[v].cast<double>();
            cell[v] = block.particles.position[v].cast<double>();
        }
        const auto total = [&](const Cell& of) {
            const double ratio = 1.0 - 2.0 * nu;
            double sum = energy(rest, of, ratio, double{block.mesh.settings.hourglass_hardening}) * mu /
                         (cell_modulus * ratio);
            for (unsigned v = 0; v < 8; ++v) {
                const double lost = std::max(0.0, double{threshold} - corner_volume(of, v));
                sum += mu / ratio * std::pow(cell_edge, 3) / 16.0 * lost * lost;
            }
            return sum;
        };
        const Vec3d pull = spring * (to - block.particles.position[7]).cast<double>();
        for (int axis = 0; axis < 3; ++axis) {
            constexpr double step = 1e-7;
            Cell up = cell;
            Cell down = cell;
            up[7][axis] += step;
            down[7][axis] -= step;
            EXPECT_NEAR((total(up) - total(down)) / (2.0 * step), pull[axis], 1e-3 * pull.norm());
        }
        const double left = corner_volume(cell, 7);
        if (threshold > 0.0f) {
            EXPECT_GT(left, 0.0) << "the corner resists";
        } else {
            EXPECT_LT(left, 0.0) << "the cell's volume alone lets the corner in";
        }
    }
}

TEST(HexahedralMesh, InstructionSetDoesNotChangeBits) {
    std::vector<Vec3f> found[2];
    for (const bool avx2 : {false, true}) {
        HexahedralBlock block(5, 4, 3, 0.49, true);
        block.mesh.use_avx2(avx2 && has_avx2());
        for (int k = 0; k < 40; ++k) {
            block.step({3.0f, 0.0f, 20.0f});
        }
        found[avx2 ? 1 : 0] = block.particles.position;
    }
    EXPECT_EQ(found[0], found[1]);
}

TEST(HexahedralMesh, ThreadCountDoesNotChangeBits) {
    std::vector<Vec3f> found[2];
    for (const std::size_t threads : {1u, 3u}) {
        test::with_threads(threads, [&] {
            HexahedralBlock block(5, 4, 3, 0.49, true);
            for (int k = 0; k < 40; ++k) {
                block.step({3.0f, 0.0f, 20.0f});
            }
            found[threads == 1 ? 0 : 1] = block.particles.position;
        });
    }
    EXPECT_EQ(found[0], found[1]);
}

TEST(HexahedralMesh, StepDoesNotAllocate) {
    HexahedralBlock block(4, 4, 3, 0.49, true);
    block.step();
    const long before = test::allocations_here();
    block.step();
    EXPECT_EQ(test::allocations_here(), before);
}

// A contact within the mesh pushes a particle and the corners around a point with opposite forces. Converged
// iterations keep the elements' forces in balance.
TEST(HexahedralMesh, SelfContactConservesMomentum) {
    HexahedralBlock block(3, 3, 3, 0.45, false);
    block.mesh.settings.iterations = 200;
    MeshContact contact;
    contact.particle = {63, 0, 1, 4, 16};
    contact.share = {1.0f, -0.4f, -0.3f, -0.2f, -0.1f};
    contact.corners = 5;
    contact.within_mesh = true;
    contact.normal = Vec3f(1.0f, 2.0f, 2.0f) / 3.0f;
    contact.gap = -0.5e-3f;
    block.mesh.self_contacts = {contact};
    block.step();
    ASSERT_GT(block.mesh.self_contacts.front().force.norm(), 0.0f);
    Vec3d sum = Vec3d::Zero();
    double size = 0.0;
    for (std::size_t i = 0; i < block.particles.size(); ++i) {
        const Vec3d momentum = (block.particles.position[i] - block.particles.rest[i]).cast<double>() /
                               double{block.particles.inverse_mass[i]};
        sum += momentum;
        size += momentum.norm();
    }
    EXPECT_LT(sum.norm(), 1e-4 * size);
}

}  // namespace
}  // namespace eti::pbd
