// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_ellipsoids.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/math/random.hpp"

namespace eti {
namespace {

constexpr float fluid_spacing = 1e-3f;

// A lattice of `size` particles along each axis.
std::vector<Vec3f> lattice(const Eigen::Vector3i& size) {
    std::vector<Vec3f> points;
    for (int z = 0; z < size.z(); ++z) {
        for (int y = 0; y < size.y(); ++y) {
            for (int x = 0; x < size.x(); ++x) {
                points.push_back(fluid_spacing * Eigen::Vector3i(x, y, z).cast<float>());
            }
        }
    }
    return points;
}

TEST(LiquidEllipsoids, SeparateDropIsParticlesSphere) {
    view::LiquidEllipsoids liquid;
    const std::vector<Vec3f> places{{0, 0, 0}, {0.1f, 0, 0}};
    liquid.fit(places, fluid_spacing);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const view::LiquidEllipsoid& drop = liquid.ellipsoids()[i];
        EXPECT_EQ(drop.centre, places[i]);
        EXPECT_NEAR(drop.volume(), std::pow(fluid_spacing, 3.0f), 0.01e-9f) << "a cube of its spacing";
        EXPECT_EQ(drop.radii.minCoeff(), drop.radii.maxCoeff());
    }
    liquid.fit({}, fluid_spacing);
    EXPECT_TRUE(liquid.ellipsoids().empty());
}

TEST(LiquidEllipsoids, BulkIsRound) {
    view::LiquidEllipsoids liquid;
    const std::vector<Vec3f> cube = lattice({5, 5, 5});
    liquid.fit(cube, fluid_spacing);
    const view::LiquidEllipsoid& middle = liquid.ellipsoids()[62];
    EXPECT_LT((middle.centre - cube[62]).norm(), 1e-7f);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(middle.radii[axis], fluid_spacing, 0.01f * fluid_spacing);
    }
}

TEST(LiquidEllipsoids, FilmIsFlatAlongItsSurface) {
    // A film in a plane tilted about x.
    const Eigen::AngleAxisf tilt(0.7f, Vec3f::UnitX());
    std::vector<Vec3f> film = lattice({7, 7, 1});
    for (Vec3f& place : film) {
        place = tilt * place;
    }
    view::LiquidEllipsoids liquid;
    liquid.fit(film, fluid_spacing);
    const view::LiquidEllipsoid& middle = liquid.ellipsoids()[24];
    const Vec3f thin = middle.rotation * Vec3f::UnitX();
    EXPECT_NEAR(std::abs(thin.dot(tilt * Vec3f::UnitZ())), 1.0f, 1e-4f);
    EXPECT_NEAR(middle.radii[0], view::LiquidEllipsoids::thinnest * fluid_spacing, 1e-7f);
    EXPECT_GT(middle.radii[1], 2.5f * middle.radii[0]);
}

// Particles that lie unevenly within a layer become a surface less uneven than they.
TEST(LiquidEllipsoids, SmoothUnevenFilm) {
    Random random(5);
    std::vector<Vec3f> film = lattice({12, 12, 1});
    for (Vec3f& place : film) {
        place.z() += 0.4f * fluid_spacing * (random.uniform() - 0.5f);
    }
    view::LiquidEllipsoids liquid;
    liquid.fit(film, fluid_spacing);
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < film.size(); ++i) {
        before += static_cast<double>(film[i].z() * film[i].z());
        const float z = liquid.ellipsoids()[i].centre.z();
        after += static_cast<double>(z * z);
    }
    // The mean of 8 neighbours has a variance of some eighth; at the edges there are fewer.
    EXPECT_LT(after, 0.35 * before);
}

}  // namespace
}  // namespace eti
