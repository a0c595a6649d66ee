// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/parts/parts.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include "common/mesh/check.hpp"

namespace eti::devices {
namespace {

constexpr double pi = std::numbers::pi;

/// Extent of a mesh along an axis [m].
std::pair<float, float> extent(const TriangleMesh& mesh, int axis) {
    float low = 1.0f, high = -1.0f;
    for (const Vec3f& v : mesh.vertices) {
        low = std::min(low, v[axis]);
        high = std::max(high, v[axis]);
    }
    return {low, high};
}

class Laryngoscopes : public ::testing::TestWithParam<Blade> {};

TEST_P(Laryngoscopes, AreClosedAndMatchTheModelsLength) {
    const Laryngoscope scope = make_laryngoscope(GetParam());
    const PartSettings settings;
    const TriangleMesh mesh = laryngoscope_part(scope, settings);
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, 2) << "a blind bore makes no handle";
    // The surface is extracted from a grid and simplified by a tenth of its spacing: accurate to the spacing.
    EXPECT_NEAR(extent(mesh, 2).second, scope.blade_length, settings.spacing);
    // The bore removes the round end's pole and leaves its rim.
    const float bore = 0.5f * settings.stylus_diameter + settings.clearance,
                radius = scope.capsules[0].radius;
    EXPECT_NEAR(extent(mesh, 1).second, scope.capsules[0].b.y() + std::sqrt(radius * radius - bore * bore),
                settings.spacing);
    EXPECT_NEAR(extent(mesh, 0).second, scope.capsules[0].radius, settings.spacing);
}

INSTANTIATE_TEST_SUITE_P(Blades, Laryngoscopes, ::testing::Values(Blade::miller_0, Blade::miller_1));

TEST(LaryngoscopePart, BoreHasTheVolumeOfTheStylus) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    PartSettings shallow, deep;
    shallow.stylus_depth = 20e-3f;
    deep.stylus_depth = 40e-3f;
    const double less = check(laryngoscope_part(scope, deep)).volume;
    const double more = check(laryngoscope_part(scope, shallow)).volume;
    const double radius =
        0.5 * static_cast<double>(deep.stylus_diameter) + static_cast<double>(deep.clearance);
    const double expected = pi * radius * radius * 20e-3;
    // A grid of 0.4 mm cuts a circle of 3.4 mm by at most 3 h^2 / 8 r = 0.018 mm in radius: 1 % of the area;
    // and its ends by a tenth of the spacing.
    EXPECT_NEAR(more - less, expected, 0.03 * expected);
}

TEST(LaryngoscopePart, TooThickStylusIsRefused) {
    PartSettings settings;
    settings.stylus_diameter = 16e-3f;
    EXPECT_THROW((void)laryngoscope_part(make_laryngoscope(Blade::miller_1), settings),
                 std::invalid_argument);
}

TEST(TubeConnector, IsClosedWithAThroughBore) {
    for (const float inner : {2.5e-3f, 3.0e-3f, 3.5e-3f}) {
        Tube tube;
        tube.inner_diameter = inner;
        tube.outer_diameter = outer_diameter_of(inner);
        const TriangleMesh mesh = tube_connector_part(tube, {});
        const MeshReport report = check(mesh);
        EXPECT_TRUE(report.is_valid()) << report.describe();
        EXPECT_EQ(report.components, 1u);
        EXPECT_EQ(report.euler_characteristic, 0) << "one hole goes through, the sensor's does not";
        for (const Vec3f& v : mesh.vertices) {
            ASSERT_GT(std::hypot(v.x(), v.y()), 0.5f * tube.outer_diameter);
        }
    }
}

TEST(Board, HasADimpleAtEveryPoint) {
    const std::vector<Eigen::Vector3d> points = {{0.02, 0, 0}, {-0.02, 0, 0}, {0, 0, 0.03}, {0, -0.01, 0.01}};
    const TriangleMesh mesh = board_part(points, {});
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.components, 1u);
    for (const Eigen::Vector3d& point : points) {
        float nearest = 1.0f;
        for (const Vec3f& v : mesh.vertices) {
            nearest = std::min(nearest, (v - point.cast<float>()).norm());
        }
        // Half a ball of 1 mm, to the grid's spacing.
        EXPECT_NEAR(nearest, tip_ball_radius, 0.2e-3f);
    }
}

// The files in deploy/data/parts equal the current output and are closed after merging STL's repeated
// vertices.
TEST(ShippedParts, AreClosed) {
    int found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PARTS)) {
        if (entry.path().extension() != ".stl") {
            continue;
        }
        ++found;
        std::ifstream stream(entry.path(), std::ios::binary);
        stream.ignore(80);
        std::uint32_t count = 0;
        stream.read(reinterpret_cast<char*>(&count), sizeof count);
        ASSERT_EQ(std::filesystem::file_size(entry.path()), 84u + 50u * count);
        TriangleMesh mesh;
        std::map<std::array<float, 3>, std::uint32_t> known;
        for (std::uint32_t i = 0; i < count; ++i) {
            std::array<float, 12> facet{};
            stream.read(reinterpret_cast<char*>(facet.data()), sizeof facet);
            stream.ignore(2);
            Triangle triangle{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::array<float, 3> p{facet[3 * k + 3], facet[3 * k + 4], facet[3 * k + 5]};
                const auto [at, fresh] =
                    known.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
                if (fresh) {
                    mesh.vertices.push_back(1e-3f * Vec3f(p[0], p[1], p[2]));
                }
                triangle[k] = at->second;
            }
            mesh.triangles.push_back(triangle);
        }
        const MeshReport report = check(mesh);
        EXPECT_TRUE(report.is_valid()) << entry.path() << report.describe();
        EXPECT_GT(report.volume, 0.1e-6);
    }
    EXPECT_EQ(found, 4);
}

}  // namespace
}  // namespace eti::devices
