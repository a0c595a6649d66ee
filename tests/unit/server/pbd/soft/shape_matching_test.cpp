// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/shape_matching.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "common/math/random.hpp"
#include "server/pbd/rotation.hpp"
#include "tests/support/cluster_block.hpp"
#include "tests/support/random_vector.hpp"
#include "tests/support/threads.hpp"

namespace eti::pbd {
namespace {

Quatf random_rotation(Random& random) {
    return Quatf(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
}

SoftBody block(int n, float youngs_modulus, const Vec3f& at = Vec3f::Zero()) {
    return test::cluster_block(n, youngs_modulus, at);
}

using test::random_vector;
using test::substep;

/// The rotation to which extract_rotation() converges.
Quatf extract_rotation(const Mat3f& a, const Quatf& rotation, int iterations) {
    float columns[3][3];
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 3; ++i) {
            columns[c][i] = a(i, c);
        }
    }
    Quatf found = rotation;
    for (int i = 0; i < iterations; ++i) {
        float q[4] = {found.x(), found.y(), found.z(), found.w()};
        pbd::extract_rotation(columns, q, 1);
        found = Quatf(q[3], q[0], q[1], q[2]).normalized();
    }
    return found;
}

TEST(ExtractRotation, MatchesSingularValueDecomposition) {
    // Reference: R = U V^T of Eigen's Jacobi SVD. Started within 0.2 rad, three steps of the fixed-point
    // iteration converge to float precision on well-conditioned matrices.
    Random random(1);
    for (int trial = 0; trial < 200; ++trial) {
        const Quatf truth = random_rotation(random);
        Mat3f stretch = Mat3f::Identity();
        for (int k = 0; k < 3; ++k) {
            stretch(k, k) = 0.7f + 0.6f * random.uniform();
        }
        const Quatf axes = random_rotation(random);
        const Mat3f a = truth.toRotationMatrix() * axes.toRotationMatrix() * stretch *
                        axes.toRotationMatrix().transpose();
        const Eigen::JacobiSVD<Mat3f> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Mat3f reference = svd.matrixU() * svd.matrixV().transpose();
        const Quatf start = (quaternion_from(0.1f * random_vector(random).normalized()) * truth).normalized();
        const Mat3f found = extract_rotation(a, start, 8).toRotationMatrix();
        EXPECT_LT((found - reference).cwiseAbs().maxCoeff(), 2e-5f);
    }
}

TEST(ExtractRotation, IsProperForDegenerateAndInvertedMatrices) {
    for (const Vec3f& diagonal :
         {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0), Vec3f(1, 1, -1), Vec3f(-1, -1, -1)}) {
        const Mat3f r = extract_rotation(diagonal.asDiagonal(), quaternion_from({0.3f, -0.2f, 0.5f}), 20)
                            .toRotationMatrix();
        EXPECT_TRUE(r.allFinite());
        EXPECT_NEAR(r.determinant(), 1.0f, 1e-5f);
    }
}

TEST(ShapeMatching, LeavesRigidMotionAlone) {
    // A rigidly moved body has no strain: corrections stay at float rounding of 0.1 m coordinates
    // (6e-9 m) times a few operations.
    SoftBody body = block(5, 8e3f, {0.05f, -0.03f, 0.02f});
    const RigidTransform move{quaternion_from({0.4f, 0.2f, -0.3f}), {0.02f, 0.01f, -0.04f}};
    for (std::size_t i = 0; i < body.particles.size(); ++i) {
        body.particles.predicted[i] = move * body.particles.rest[i];
    }
    const std::vector<Vec3f> before = body.particles.predicted;
    for (int pass = 0; pass < 20; ++pass) {  // the rotation starts half a radian away
        body.shapes.fit(body.particles.predicted);
    }
    body.shapes.project(body.particles, 1e-3f);
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_LT((body.particles.predicted[i] - before[i]).norm(), 1e-7f);
    }
}

TEST(ShapeMatching, ConservesMomentumOfAFreeBody) {
    SoftBody body = block(5, 8e3f);
    Random random(3);
    for (std::size_t i = 0; i < body.particles.size(); ++i) {
        body.particles.position[i] += 2e-4f * random_vector(random);
        body.particles.velocity[i] = 0.02f * random_vector(random) + Vec3f(0.1f, 0, 0);
    }
    const auto momentum = [&] {
        Vec3d sum = Vec3d::Zero();
        for (std::size_t i = 0; i < body.particles.size(); ++i) {
            sum += body.particles.velocity[i].cast<double>() /
                   static_cast<double>(body.particles.inverse_mass[i]);
        }
        return sum;
    };
    const Vec3d before = momentum();
    for (int n = 0; n < 1000; ++n) {
        substep(body, 1.0f / 1440.0f);
    }
    // A position near 0.1 m rounds by 2e-9 m (RMS) in each of about three operations, a velocity by that over
    // dt: 5e-6 m/s per particle and step. Particles that move alike round alike, so the errors of 125
    // particles of 8 mg add up, and those of 1000 steps are a random walk: 125 * 8e-6 * 5e-6 * sqrt(1000) is
    // 1.7e-7 kg m/s; three times that.
    EXPECT_LT((momentum() - before).norm(), 5e-7);
}

TEST(ShapeMatching, NeverGainsEnergyUnforced) {
    SoftBody body = block(4, 8e3f);
    Random random(4);
    for (Vec3f& x : body.particles.position) {
        x += 5e-4f * random_vector(random);
    }
    float last = 1e9f;
    for (int n = 0; n < 400; ++n) {
        substep(body, 1.0f / 1440.0f);
        float kinetic = 0.0f;
        for (const Vec3f& v : body.particles.velocity) {
            kinetic += 0.5f * 8e-6f * v.squaredNorm();
        }
        if (n % 100 == 99) {
            EXPECT_LT(kinetic, last);
            last = kinetic;
        }
    }
}

TEST(ShapeMatching, ReturnsFromCollapseToAPoint) {
    SoftBody body = block(4, 8e3f);
    body.settings.damping = 10.0f;
    for (Vec3f& x : body.particles.position) {
        x = Vec3f(0.003f, 0.003f, 0.003f);
    }
    Random random(5);
    for (Vec3f& x : body.particles.position) {
        x += 1e-6f * random_vector(random);
    }
    for (int n = 0; n < 3000; ++n) {
        substep(body, 1.0f / 1440.0f);
    }
    // Back at rest up to a rigid motion: side lengths within 1 %.
    const float side = (body.particles.position[3] - body.particles.position[0]).norm();
    EXPECT_NEAR(side, 6e-3f, 6e-5f);
}

TEST(ShapeMatching, SameBitsForAnyNumberOfThreads) {
    const auto run = [](std::size_t threads) {
        return test::with_threads(threads, [] {
            SoftBody body = block(9, 8e3f);
            for (Vec3f& v : body.particles.velocity) {
                v = 0.3f * Vec3f(v.x() + 1.0f, 0.2f, 0.0f);
            }
            body.particles.position[17] += Vec3f(1e-3f, 0, 0);
            for (int n = 0; n < 50; ++n) {
                substep(body, 1.0f / 1440.0f);
            }
            return body.particles.position;
        });
    };
    const auto one = run(1);
    EXPECT_EQ(one, run(2));
    EXPECT_EQ(one, run(8));
}

TEST(ShapeMatching, SameBitsForAnyInstructionSet) {
    const auto run = [](bool avx2) {
        SoftBody body = block(9, 8e3f);
        if (!avx2) {
            body.shapes.use_avx2(false);
        }
        body.particles.position[17] += Vec3f(1e-3f, 0, 0);
        for (int n = 0; n < 50; ++n) {
            substep(body, 1.0f / 1440.0f);
        }
        return body.particles.position;
    };
    EXPECT_EQ(run(true), run(false));
}

TEST(ShapeMatching, ForceOfAHeldParticleFollowsTheSpring) {
    // One cluster, one particle displaced by d and held there: each substep pulls it back by share * (goal -
    // x). With k h^2 << m the impulse per substep is that of the membership's spring: m * move / h^2 -> k
    // (goal - x); the error is share itself (first order in h^2 k / m).
    SoftBody body = block(3, 2e3f);
    const float dt = 1.0f / 20000.0f;
    body.particles.predicted = body.particles.rest;
    body.particles.predicted[0].x() -= 1e-4f;
    body.shapes.project(body.particles, dt);
    const float mass = 8e-6f;
    const float force =
        mass * (body.particles.predicted[0].x() - (body.particles.rest[0].x() - 1e-4f)) / (dt * dt);
    // k = 5 E V / (n r^2), n = 1; r^2 = 5/3 <q^2>; 27 points of a cube: <q^2> = 2 h^2.
    const float h = 2e-3f;
    const float k = 5.0f * 2e3f * h * h * h / (5.0f / 3.0f * 2.0f * h * h);
    // The fit follows the displaced particle: its goal moves by the particle's own share. For a corner of 27:
    // translation 1/27, rotation (q x e_x)^2 / (sum q^2 about the axes).
    const float followed = 1.0f / 27.0f + 2.0f * (h * h) / (36.0f * h * h);
    EXPECT_NEAR(force, k * 1e-4f * (1.0f - followed), 0.02f * k * 1e-4f);
}

TEST(ShapeMatching, SetYoungsModulusMatchesConstruction) {
    const auto run = [](float configured, std::optional<float> later) {
        SoftBody body = block(5, configured);
        if (later) {
            body.shapes.set_youngs_modulus(std::vector<float>(body.shapes.size(), *later));
        }
        body.particles.position[0] += Vec3f(2e-3f, 0, 0);
        for (int k = 0; k < 20; ++k) {
            substep(body, 1e-3f);
        }
        return body.particles.position;
    };
    const std::vector<Vec3f> wanted = run(5e3f, {}), set = run(8e3f, 5e3f), other = run(8e3f, {});
    float apart = 0.0f, otherwise = 0.0f;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        apart = std::max(apart, (set[i] - wanted[i]).norm());
        otherwise = std::max(otherwise, (other[i] - wanted[i]).norm());
    }
    // Rounding of a spring, in some coordinates of some hundredths of a metre.
    EXPECT_LT(apart, 1e-7f);
    EXPECT_GT(otherwise, 1e-5f);
}

}  // namespace
}  // namespace eti::pbd
