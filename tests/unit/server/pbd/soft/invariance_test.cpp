// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Results must not depend on a body's position, its orientation and the numbering of its particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "common/math/random.hpp"
#include "tests/support/cluster_block.hpp"

namespace eti::pbd {
namespace {

constexpr float invariance_dt = 1.0f / 1440.0f;
constexpr int substep_count = 20;

/// A block of clusters, thrown and perturbed in the same way in every frame; its state after some substeps.
Particles thrown(const RigidTransform& frame) {
    SoftBody body = test::cluster_block(5, 8e3f);
    Particles& p = body.particles;
    Random random(5);
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3f shaken(random.normal(), random.normal(), random.normal());
        const Vec3f rest = p.rest[i];
        p.rest[i] = frame * rest;
        p.position[i] = p.predicted[i] = frame * Vec3f(rest + 2e-4f * shaken);
        p.velocity[i] = frame.rotation * Vec3f(0.4f, -0.2f, 0.3f);
    }
    // The rest shape has moved with it.
    body.shapes.set_rest(p);
    body.shapes.reset();
    for (int n = 0; n < substep_count; ++n) {
        test::substep(body, invariance_dt);
    }
    return p;
}

/// RMS distance [m] of two runs, each in its own frame.
double bodies_apart(const Particles& a, const RigidTransform& frame, const Particles& b) {
    const auto rotation = frame.rotation.cast<double>();
    const Vec3d translation = frame.translation.cast<double>();
    double squared = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec3d expected = rotation * b.position[i].cast<double>() + translation;
        squared += (a.position[i].cast<double>() - expected).squaredNorm();
    }
    return std::sqrt(squared / static_cast<double>(a.size()));
}

/// Float32 rounding [m] accumulated over `steps` substeps at coordinates of `distance` [m]. A position is
/// rounded by u = ulp / sqrt(12) in each coordinate when it is predicted and when it is corrected. The
/// velocity, the positions' difference, keeps the error: after n steps it is a random walk of u sqrt(2 n^3 /
/// 3) in each of three directions. The start and the rest shape, which is rounded too, add a few u.
double stepping_rounding(double distance, int steps) {
    const double ulp = std::exp2(std::floor(std::log2(distance)) - 23.0);
    const double u = ulp / std::sqrt(12.0);
    return std::sqrt(3.0) * u * (std::sqrt(2.0 / 3.0 * std::pow(steps, 3.0)) + 10.0);
}

class Invariance : public testing::TestWithParam<float> {};

// At most three times the model; but more than a hundredth of it, otherwise the model says nothing.
TEST_P(Invariance, ToTranslationUpToRounding) {
    const float far = GetParam();
    const RigidTransform shift{Quatf::Identity(), far * Vec3f(0.6f, -0.64f, 0.48f)};
    const double model = stepping_rounding(0.64 * double{far}, substep_count);
    const double apart = bodies_apart(thrown(shift), shift, thrown({}));
    EXPECT_LT(apart, 3.0 * model);
    EXPECT_GT(apart, 0.01 * model);
    // In 20 substeps it flies 7.5 mm.
    EXPECT_LT(3.0 * model, 7.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Metres, Invariance, testing::Values(0.1f, 1.0f, 10.0f, 100.0f));

TEST(Invariance, ToRotation) {
    // Coordinates stay within 16 mm of the origin; clusters' rotations are accurate to a microradian, 5e-9 m
    // over a cluster, in every substep.
    const RigidTransform turn{Quatf(Eigen::AngleAxisf(2.1f, Vec3f(0.48f, 0.6f, 0.64f))), Vec3f::Zero()};
    const double model = stepping_rounding(16e-3, substep_count);
    EXPECT_LT(bodies_apart(thrown(turn), turn, thrown({})), 3.0 * model + substep_count * 5e-9);
    // An unrotated body differs by millimetres.
    EXPECT_GT(bodies_apart(thrown(turn), {}, thrown({})), 1e-3);
}

TEST(Invariance, OfClustersToReordering) {
    const SoftBody plain = test::cluster_block(5, 8e3f);
    Random random(6);
    const auto shuffled = [&random](std::size_t size) {
        std::vector<std::uint32_t> order(size);
        std::iota(order.begin(), order.end(), 0u);
        for (std::size_t i = size - 1; i > 0; --i) {
            std::swap(order[i], order[random.bits() % (i + 1)]);
        }
        return order;
    };
    const std::size_t particles = plain.particles.size();
    const std::vector<std::uint32_t> place = shuffled(particles);
    SoftBody a = plain, b = plain;
    ShapeMatching::Description description;
    description.first.push_back(0);
    for (const std::uint32_t c : shuffled(plain.shapes.size())) {
        std::vector<std::uint32_t> members;
        for (std::uint32_t i = 0; i < particles; ++i) {
            const auto clusters_of = plain.shapes.clusters_of(i);
            if (std::ranges::find(clusters_of, c) != clusters_of.end()) {
                members.push_back(place[i]);
            }
        }
        for (const std::uint32_t k : shuffled(members.size())) {
            description.member.push_back(members[k]);
        }
        description.first.push_back(static_cast<std::uint32_t>(description.member.size()));
    }
    constexpr float volume = test::cluster_spacing * test::cluster_spacing * test::cluster_spacing;
    description.youngs_modulus.assign(plain.shapes.size(), 8e3f);
    description.particle_volume.assign(particles, volume);
    description.fitting_mass.assign(particles, test::cluster_particle_mass);
    for (std::size_t i = 0; i < particles; ++i) {
        a.particles.position[i] += 2e-4f * Vec3f(random.normal(), random.normal(), random.normal());
        a.particles.velocity[i] = Vec3f(0.4f, -0.2f, 0.3f);
        b.particles.rest[place[i]] = a.particles.rest[i];
        b.particles.position[place[i]] = a.particles.position[i];
        b.particles.velocity[place[i]] = a.particles.velocity[i];
    }
    b.shapes.configure(description, b.particles);
    for (int n = 0; n < substep_count; ++n) {
        test::substep(a, invariance_dt);
        test::substep(b, invariance_dt);
    }
    // A Jacobi pass has no order: only the order of summation differs.
    double worst = 0.0;
    for (std::size_t i = 0; i < particles; ++i) {
        worst = std::max(
            worst, static_cast<double>((a.particles.position[i] - b.particles.position[place[i]]).norm()));
    }
    EXPECT_LT(worst, 3.0 * stepping_rounding(16e-3, substep_count) + substep_count * 5e-9);
    EXPECT_GT(worst, 0.0) << "the order is another";
}

}  // namespace
}  // namespace eti::pbd
