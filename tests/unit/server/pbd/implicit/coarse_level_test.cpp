// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/coarse_level.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/math/random.hpp"
#include "tests/support/tetrahedral_body.hpp"

namespace eti::pbd {
namespace {

constexpr float cell = 2.5e-3f;  // [m]

/// A bar of 8 x 8 x 24 cells of 8 kPa; `held`: by its lowest layer.
struct Bar {
    test::TetrahedralBody body;
    std::vector<float> inverse_mass;
    CoarseLevel level;
    CoarseLevel::Wide residual;

    explicit Bar(bool held)
        : body(test::tetrahedral_lattice(8, 8, 24, static_cast<double>(cell)), 8e3f, 0.45f) {
        CoarseLevel::Wide rest;
        for (const std::uint32_t i : body.tetrahedra.particles()) {
            const Vec3f& x = body.particles.rest[i];
            rest.emplace_back(x.x(), x.y(), x.z(), 0.0f);
            inverse_mass.push_back(held && x.z() < 1e-6f ? 0.0f : body.particles.inverse_mass[i]);
        }
        level.configure(rest, inverse_mass, body.tetrahedra, {}, cell, 9.0f);
        residual.assign(rest.size(), Eigen::Vector4f::Zero());
    }

    CoarseLevel::Wide correct(const CoarseLevel::Wide& by) {
        CoarseLevel::Motion force = level.zero_motion();
        for (std::size_t k = 0; k < by.size(); ++k) {
            level.restrict_to(force, k, load_float4(by[k]));
        }
        level.solve(force);
        CoarseLevel::Wide to(by.size(), Eigen::Vector4f::Zero());
        for (std::size_t k = 0; k < by.size(); ++k) {
            put(level.displacement(k), to[k]);
        }
        return to;
    }
};

TEST(CoarseLevel, HasTensOfNodes) {
    EXPECT_GT(Bar(true).level.size(), 20u);
    EXPECT_LT(Bar(true).level.size(), 100u);
}

TEST(CoarseLevel, FreeBodyAcceleratesByItsMass) {
    // Elements do not resist a common translation of all corners: the acceleration times dt^2. Nodes with
    // almost no attached mass lag by a part of that.
    Bar bar(false);
    constexpr float dt = 1e-4f;
    bar.level.begin(1.0f / (dt * dt));
    bar.level.factorise();
    const Vec3f acceleration(1.0f, -9.81f, 3.0f);
    for (std::size_t k = 0; k < bar.residual.size(); ++k) {
        bar.residual[k].head<3>() = acceleration / bar.inverse_mass[k];
    }
    double squared = 0.0;
    for (const Eigen::Vector4f& way : bar.correct(bar.residual)) {
        squared += static_cast<double>((way.head<3>() / (dt * dt) - acceleration).squaredNorm());
    }
    EXPECT_LT(std::sqrt(squared / static_cast<double>(bar.residual.size())), 1e-3 * acceleration.norm());
}

TEST(CoarseLevel, SpringDeflectionIsForceOverStiffness) {
    // As many springs as corners, and almost no mass: force over stiffness.
    Bar bar(false);
    bar.level.begin(1e-3f);
    constexpr float stiffness = 5.0f;
    const Vec3f force(0.01f, 0.02f, -0.03f);
    for (std::uint32_t k = 0; k < bar.residual.size(); ++k) {
        bar.level.add_spring(k, stiffness);
        bar.residual[k].head<3>() = force;
    }
    bar.level.factorise();
    for (const Eigen::Vector4f& way : bar.correct(bar.residual)) {
        EXPECT_NEAR((way.head<3>() - force / stiffness).norm(), 0.0f, 1e-2f * force.norm() / stiffness);
    }
}

TEST(CoarseLevel, IsSymmetricPositiveAndKeepsFixedParticles) {
    Bar bar(true);
    bar.level.begin(180.0f * 180.0f);
    bar.level.add_spring(std::array{3u, 90u}, std::array{0.3f, 0.7f}, 40.0f);
    bar.level.add_spring(std::array{3u, 90u, 150u}, std::array{1.0f, -0.4f, -0.6f}, 20.0f);
    bar.level.factorise();
    Random random(1);
    const auto any = [&] {
        CoarseLevel::Wide out = bar.residual;
        for (Eigen::Vector4f& v : out) {
            v.head<3>() = Vec3f(random.normal(), random.normal(), random.normal());
        }
        return out;
    };
    const auto dot = [](const CoarseLevel::Wide& a, const CoarseLevel::Wide& b) {
        double sum = 0.0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            sum += static_cast<double>(a[k].head<3>().dot(b[k].head<3>()));
        }
        return sum;
    };
    const CoarseLevel::Wide a = any();
    const CoarseLevel::Wide b = any();
    const CoarseLevel::Wide of_a = bar.correct(a);
    const CoarseLevel::Wide of_b = bar.correct(b);
    EXPECT_GT(dot(a, of_a), 0.0);
    EXPECT_GT(dot(b, of_b), 0.0);
    EXPECT_NEAR(dot(a, of_b), dot(b, of_a), 1e-3 * std::sqrt(dot(a, of_a) * dot(b, of_b)));
    for (std::size_t k = 0; k < of_a.size(); ++k) {
        EXPECT_TRUE(bar.inverse_mass[k] > 0.0f || of_a[k].isZero(0.0f));
    }
}

}  // namespace
}  // namespace eti::pbd
