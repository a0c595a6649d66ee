// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Gradients of all constraints against central differences of their values. Each tolerance is validated: it
// must detect a gradient that is off by a hundredth.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <functional>
#include <numbers>

#include "common/math/random.hpp"
#include "server/pbd/fluid/fluid_kernel.hpp"
#include "server/pbd/implicit/neo_hookean.hpp"
#include "server/pbd/rod/rod_joint.hpp"
#include "server/pbd/soft/links.hpp"
#include "tests/support/cluster_block.hpp"

namespace eti::pbd {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Value = std::function<double(const VectorXd&)>;

/// Second-order central differences; errors of step^2 times the third derivative and of rounding over step.
VectorXd differences(const Value& value, const VectorXd& at, double step) {
    VectorXd out(at.size());
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        VectorXd up = at;
        VectorXd down = at;
        up[i] += step;
        down[i] -= step;
        out[i] = (value(up) - value(down)) / (2.0 * step);
    }
    return out;
}

/// `tolerance` relative to the gradient's length.
void expect_gradient(const VectorXd& claimed, const Value& value, const VectorXd& at, double step,
                     double tolerance) {
    const VectorXd expected = differences(value, at, step);
    ASSERT_GT(expected.norm(), 0.0);
    EXPECT_LT((claimed - expected).norm(), tolerance * expected.norm());
    EXPECT_GT((1.01 * claimed - expected).norm(), tolerance * expected.norm()) << "tells nothing";
    // The direction must be right, too.
    VectorXd turned = claimed;
    turned[0] += 0.02 * claimed.norm();
    EXPECT_GT((turned - expected).norm(), tolerance * expected.norm()) << "tells nothing";
}

Vec3d random_vector_3d(Random& random) {
    return {double{random.normal()}, double{random.normal()}, double{random.normal()}};
}

// C = |b - a| - length. XPBD (Macklin et al. 2016, eq. 18) from a multiplier of zero moves each end by -w
// grad C C / (w_a + w_b + 1 / (k dt^2)), so the moves times that over w C are the gradient. Float32: ends
// 1e-2 m from the origin round by 5e-10 m, of moves of 1e-3 m and more: 1e-6.
TEST(Gradient, DistanceLinkMatchesFiniteDifferences) {
    Random random(1);
    for (int trial = 0; trial < 50; ++trial) {
        const float length = 5e-3f, wa = 1e5f, wb = 3e5f, stiffness = 1e4f, dt = 1e-3f;
        Vec3f a = (3e-3 * random_vector_3d(random)).cast<float>();
        Vec3f b = a + (length + 4e-3f) * random_vector_3d(random).normalized().cast<float>();
        VectorXd at(6);
        at << a.cast<double>(), b.cast<double>();
        const Value value = [&](const VectorXd& x) {
            return (x.tail<3>() - x.head<3>()).norm() - double{length};
        };
        project_link(a, b, wa, wb, length, stiffness, dt);
        VectorXd moved(6);
        moved << a.cast<double>(), b.cast<double>();
        moved = at - moved;
        moved.head<3>() /= double{wa};
        moved.tail<3>() /= double{wb};
        const double multiplier =
            value(at) / (double{wa} + double{wb} + 1.0 / (double{stiffness} * double{dt} * double{dt}));
        expect_gradient(moved / multiplier, value, at, 1e-7, 1e-5);
    }
}

// The goals minimise U = 1/2 sum m |x - (R q + c)|^2 over rotations R and centres c, so by the envelope
// theorem dU/dx = m (x - goal) although R and c follow x. U by Eigen's SVD in double. The rotation is
// accurate to a microradian (2e-9 m) and float32 to 1e-9 m, of distances from the goals of 1e-3 m.
TEST(Gradient, ShapeMatchingMatchesFiniteDifferences) {
    SoftBody body = test::cluster_block(3, 8e3f);
    const std::size_t count = body.particles.size();
    Random random(2);
    for (int trial = 0; trial < 5; ++trial) {
        VectorXd at(3 * static_cast<Eigen::Index>(count));
        const Quatf turn = quaternion_from(random_vector_3d(random).cast<float>());
        for (std::size_t i = 0; i < count; ++i) {
            body.particles.predicted[i] =
                turn * body.particles.rest[i] + (4e-4 * random_vector_3d(random)).cast<float>();
            at.segment<3>(3 * static_cast<Eigen::Index>(i)) = body.particles.predicted[i].cast<double>();
        }
        const auto rest = [&](std::size_t i) { return body.particles.rest[i].cast<double>(); };
        const auto fit = [&](const VectorXd& x) {
            Vec3d centre = Vec3d::Zero(), rest_centre = Vec3d::Zero();
            for (std::size_t i = 0; i < count; ++i) {
                centre += x.segment<3>(3 * static_cast<Eigen::Index>(i)) / static_cast<double>(count);
                rest_centre += rest(i) / static_cast<double>(count);
            }
            Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
            for (std::size_t i = 0; i < count; ++i) {
                a += (x.segment<3>(3 * static_cast<Eigen::Index>(i)) - centre) *
                     (rest(i) - rest_centre).transpose();
            }
            const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
            const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
            EXPECT_GT(rotation.determinant(), 0.0);
            double energy = 0.0;
            for (std::size_t i = 0; i < count; ++i) {
                energy += 0.5 * (x.segment<3>(3 * static_cast<Eigen::Index>(i)) - centre -
                                 rotation * (rest(i) - rest_centre))
                                    .squaredNorm();
            }
            return energy;
        };
        for (int pass = 0; pass < 20; ++pass) {  // the rotation starts a radian away
            body.shapes.fit(body.particles.predicted);
        }
        const Vec3f centre = body.shapes.centre()[0], rest_centre = body.shapes.rest_centre()[0];
        VectorXd claimed(at.size());
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f goal = body.shapes.rotation()[0] * (body.particles.rest[i] - rest_centre) + centre;
            claimed.segment<3>(3 * static_cast<Eigen::Index>(i)) =
                (body.particles.predicted[i] - goal).cast<double>();
        }
        expect_gradient(claimed, fit, at, 1e-7, 2e-5);
    }
}

// C_D and C_H of Macklin & Mueller 2021 by F = D Q, from Eigen. Steps of 1e-8 m on 1e-3 m: truncation 1e-10,
// rounding 1e-16 / 1e-5 of terms up to a hundred times the gradient.
TEST(Gradient, NeoHookeanMatchesFiniteDifferences) {
    Random random(3);
    for (int trial = 0; trial < 50; ++trial) {
        VectorXd at(12);
        Eigen::Matrix3d inverse;
        do {
            Eigen::Matrix3d edges;
            edges << 1e-3 * random_vector_3d(random), 1e-3 * random_vector_3d(random),
                1e-3 * random_vector_3d(random);
            inverse = edges.inverse();
            at << 1e-3 * random_vector_3d(random), 1e-3 * random_vector_3d(random),
                1e-3 * random_vector_3d(random), 1e-3 * random_vector_3d(random);
        } while (inverse.norm() > 1e4);
        const auto deformation = [&](const VectorXd& x) {
            Eigen::Matrix3d d;
            d << x.segment<3>(3) - x.head<3>(), x.segment<3>(6) - x.head<3>(), x.segment<3>(9) - x.head<3>();
            return Eigen::Matrix3d(d * inverse);
        };
        const Eigen::Matrix3d m = inverse * inverse.transpose();
        const RestTetrahedron<double> rest{{m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)},
                                           inverse.determinant()};
        double x[4][3];
        for (int v = 0; v < 4; ++v) {
            for (int i = 0; i < 3; ++i) {
                x[v][i] = at[3 * v + i];
            }
        }
        NeoHookean<double> c;
        neo_hookean(x, rest, c);
        VectorXd deviatoric(12), hydrostatic(12);
        for (int v = 0; v < 4; ++v) {
            for (int i = 0; i < 3; ++i) {
                deviatoric[3 * v + i] = c.deviatoric[v][i] / std::sqrt(c.trace);
                hydrostatic[3 * v + i] = c.hydrostatic[v][i];
            }
        }
        expect_gradient(
            deviatoric, [&](const VectorXd& y) { return deformation(y).norm(); }, at, 1e-8, 1e-7);
        expect_gradient(
            hydrostatic, [&](const VectorXd& y) { return deformation(y).determinant(); }, at, 1e-8, 1e-6);
    }
}

// Elastic energy 1/2 C^T C / compliance of a joint's six constraints (stretch and shear, bending, twist) by
// displacements and rotations of both segments: its gradient is the Jacobians' transpose times the forces.
// Double; step 1e-6 (m, rad): truncation 1e-12 times third derivatives of order 1e3.
TEST(Gradient, RodJointMatchesFiniteDifferences) {
    Random random(4);
    for (int trial = 0; trial < 50; ++trial) {
        RodSegment a, b;
        a.behind = a.ahead = b.behind = b.ahead = 2.5e-3;
        a.rotation = exp_rotation(random_vector_3d(random));
        b.rotation = a.rotation * exp_rotation(0.4 * random_vector_3d(random));
        b.position = a.position + a.to_front() - b.to_rear() + 1e-4 * random_vector_3d(random);
        RodJoint joint;
        joint.rest = Vec3d(-0.03, 0.0, 0.0);
        Eigen::Matrix<double, 6, 1> compliance;
        compliance << 5e-7, 5e-7, 5e-7, 20.0, 20.0, 29.0;  // of the shipped tube's order, [m/N] and [rad/N m]
        const auto moved = [&](const VectorXd& y) {
            RodSegment p = a, q = b;
            p.position += y.segment<3>(0);
            p.rotation = exp_rotation(y.segment<3>(3)) * p.rotation;
            q.position += y.segment<3>(6);
            q.rotation = exp_rotation(y.segment<3>(9)) * q.rotation;
            return evaluate(joint, p, q);
        };
        const auto constraints = [](const RodJointState& state) {
            Eigen::Matrix<double, 6, 1> c;
            c << state.gap, state.angle;
            return c;
        };
        const RodJointState now = evaluate(joint, a, b);
        const VectorXd at = VectorXd::Zero(12);
        // One kind at a time, because stretch, a thousand times stiffer, would mask the others.
        for (const auto& [first, size] : {std::pair{0, 3}, std::pair{3, 2}, std::pair{5, 1}}) {
            Eigen::Matrix<double, 6, 1> stiffness = Eigen::Matrix<double, 6, 1>::Zero();
            stiffness.segment(first, size) = compliance.segment(first, size).cwiseInverse();
            const Value energy = [&](const VectorXd& y) {
                return 0.5 * constraints(moved(y)).cwiseAbs2().dot(stiffness);
            };
            const Eigen::Matrix<double, 6, 1> force = constraints(now).cwiseProduct(stiffness);
            VectorXd claimed(12);
            claimed << rear_jacobian(now).transpose() * force, front_jacobian(now).transpose() * force;
            expect_gradient(claimed, energy, at, 1e-6, 1e-5);
        }
    }
}

// The density of Macklin & Mueller 2013, eq. 2, of a particle and its neighbours: sum of V W, relative to the
// rest density. W is float32: differences over a thousandth of the radius carry 6e-8 of the peak over 2e-3 of
// it, 3e-5 of a slope of order one, and truncate by 1e-6.
TEST(Gradient, FluidDensityMatchesFiniteDifferences) {
    const FluidKernel kernel(2e-3f);
    const float volume = kernel.lattice_volume(1e-3f);
    Random random(5);
    for (int trial = 0; trial < 20; ++trial) {
        VectorXd at(3 * 8);
        for (Eigen::Index i = 0; i < at.size(); ++i) {
            at[i] = 1e-3 * (2.0 * double{random.uniform()} - 1.0);
        }
        const auto from_neighbour = [&](const VectorXd& x, Eigen::Index j) {
            return Vec3d(x.head<3>() - x.segment<3>(3 * j));
        };
        const Value density = [&](const VectorXd& x) {
            double sum = double{volume * kernel.value(0.0f)};
            for (Eigen::Index j = 1; j < 8; ++j) {
                sum += double{volume} * double{kernel.value(static_cast<float>(from_neighbour(x, j).norm()))};
            }
            return sum;
        };
        VectorXd claimed = VectorXd::Zero(at.size());
        for (Eigen::Index j = 1; j < 8; ++j) {
            const Vec3d apart = from_neighbour(at, j);
            const Vec3d slope = double{volume} *
                                double{kernel.gradient_over_distance(static_cast<float>(apart.norm()))} *
                                apart;
            claimed.head<3>() += slope;
            claimed.segment<3>(3 * j) -= slope;
        }
        expect_gradient(claimed, density, at, 2e-6, 1e-3);
    }
}

}  // namespace
}  // namespace eti::pbd
