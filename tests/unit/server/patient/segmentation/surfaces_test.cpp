// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "coarse_phantom.hpp"

namespace eti::segmentation {
namespace {

using test::coarse_phantom;
using test::silent;

/// A ball of bone in a ball of soft tissue, on a rotated, left-handed, anisotropic grid.
struct Balls {
    imaging::Volume ct;
    imaging::Mask labels;
    static constexpr double outer = 20e-3;
    static constexpr double inner = 10e-3;

    Balls() {
        imaging::Geometry& g = ct.geometry;
        g.size = {56, 56, 40};
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
        g.step = turn * Vec3d(1e-3, -1e-3, 1.4e-3).asDiagonal();
        g.origin = -g.step * Vec3d(27.3, 27.6, 19.7);
        labels.geometry = g;
        for (std::size_t i = 0; i < g.count(); ++i) {
            const auto [x, y, z] = g.coordinates(i);
            const double r = g.point(x, y, z).norm();
            // Partial volume, linear across a voxel.
            const auto share = [&](double radius) { return std::clamp((radius - r) / 1e-3 + 0.5, 0.0, 1.0); };
            const double hu = -1000.0 + 1040.0 * share(outer) + 372.0 * share(inner);
            ct.value.push_back(static_cast<float>(hu));
            labels.value.push_back(value_of(hu < -480.0  ? Label::outside
                                            : hu > 226.0 ? Label::bone
                                                         : Label::soft));
        }
    }
};

TEST(Surfaces, FollowGreyValuesOnAnyGrid) {
    const Balls balls;
    const auto surfaces = make_surfaces(balls.labels, &balls.ct, {}, silent);
    ASSERT_EQ(surfaces.size(), 2u) << "there is no airway";
    for (const NamedSurface& surface : surfaces) {
        const double radius = surface.name == "skin" ? Balls::outer : Balls::inner;
        EXPECT_TRUE(surface.report.is_valid());
        EXPECT_EQ(surface.report.components, 1u);
        // Smoothing must not shrink: a twentieth of a voxel over the whole surface.
        const double volume = 4.0 / 3.0 * M_PI * radius * radius * radius;
        EXPECT_NEAR(surface.report.volume, volume, 4.0 * M_PI * radius * radius * 0.05e-3) << surface.name;
        for (const Vec3f& v : surface.mesh.vertices) {
            // A ramp of 1 mm sampled every 1.4 mm: 0.2 mm; marching tetrahedra's clearance: 0.05 mm;
            // smoothing and flat triangles: below 0.1 mm.
            ASSERT_NEAR(v.norm(), radius, 0.35e-3) << surface.name;
        }
    }
}

TEST(Surfaces, LabelsAloneSuffice) {
    const Balls balls;
    const auto surfaces = make_surfaces(balls.labels, nullptr, {}, silent);
    ASSERT_EQ(surfaces.size(), 2u);
    const double volume = 4.0 / 3.0 * M_PI * std::pow(Balls::inner, 3);
    EXPECT_NEAR(surfaces[1].report.volume, volume, 0.05 * volume);
}

TEST(Surfaces, TriangleBudgetIsRespected) {
    const Balls balls;
    SurfaceSettings settings;
    settings.skin_triangles = 2000;
    settings.bone_triangles = 500;
    for (const NamedSurface& surface : make_surfaces(balls.labels, &balls.ct, settings, silent)) {
        EXPECT_LE(surface.mesh.triangles.size(), surface.name == "skin" ? 2000u : 500u);
        EXPECT_TRUE(surface.report.is_valid());
    }
}

TEST(Surfaces, PhantomIsClosedManifoldAndOriented) {
    const Phantom& phantom = coarse_phantom(2.0e-3f);
    const auto surfaces = make_surfaces(phantom.labels, &phantom.ct, {}, silent);
    ASSERT_EQ(surfaces.size(), 3u);
    for (const NamedSurface& surface : surfaces) {
        EXPECT_TRUE(surface.report.is_valid()) << surface.name << ": " << surface.report.describe();
    }
}

TEST(Surfaces, CtOfAnotherGridIsRefused) {
    Balls balls;
    balls.ct.geometry.origin.x() += 5e-3;
    EXPECT_THROW((void)make_surfaces(balls.labels, &balls.ct, {}, silent), imaging::VolumeError);
}

TEST(Surfaces, StlHoldsEveryTriangleInMillimetres) {
    const TriangleMesh mesh{{Vec3f(0, 0, 0), Vec3f(1e-3f, 0, 0), Vec3f(0, 2e-3f, 0)}, {{0, 1, 2}}};
    const imaging::Bytes stl = encode_stl(mesh);
    ASSERT_EQ(stl.size(), 84u + 50u);
    std::array<float, 12> numbers{};
    std::memcpy(numbers.data(), stl.data() + 84, sizeof(numbers));
    EXPECT_EQ(numbers, (std::array<float, 12>{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0}));
}

}  // namespace
}  // namespace eti::segmentation
