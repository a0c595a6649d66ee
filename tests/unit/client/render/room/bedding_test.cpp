// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/bedding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/bus/codec/frame_pose.hpp"
#include "common/math/units.hpp"
#include "synthetic_scene.hpp"

namespace eti::render {
namespace {

constexpr std::uint16_t skull_frame = 1;

class BeddingTest : public ::testing::Test {
  protected:
    void SetUp() override {
        synthetic::fill(scene_, source_);
        outline_.build(scene_);
    }

    // Turns the head about its centre, and lowers it [m].
    void pose_head(float turn, float down) {
        msg::DeformationState state = synthetic::deformation(source_, 5'000'000, 0.0f, 0.0f);
        state.frames()[skull_frame] =
            bus::encode_frame_pose(skull_frame, {source_.rest_centres[skull_frame] + Vec3f(0.0f, down, 0.0f),
                                                 Quatf(Eigen::AngleAxisf(turn, Vec3f::UnitX()))});
        scene_.apply(state);
        scene_.update();
    }

    [[nodiscard]] std::vector<Vec3f> body() const {
        std::vector<Vec3f> points;
        for (const auto& [name, surface] : scene_.surfaces()) {
            if (surface.model().tissue == Tissue::soft) {
                for (const view::LitVertex& vertex : surface.vertices()) {
                    points.push_back(vertex.position);
                }
            }
        }
        return points;
    }

    // How deep [m] the body's lowest point lies within the bedding (negative: above it), and the deepest of
    // all.
    struct Depths {
        float of_lowest = -1.0f, deepest = -1.0f;
    };
    [[nodiscard]] Depths depths(const Bedding& bedding) const {
        Depths depths;
        float lowest = -1.0f;
        for (const Vec3f& p : body()) {
            for (int row = 0; row + 1 < Bedding::rows; ++row) {
                const auto z = [&](int k) { return bedding.vertices()[index(0, k)].position.z(); };
                if (p.z() > z(row) || p.z() <= z(row + 1)) {
                    continue;
                }
                for (int column = 0; column + 1 < Bedding::columns; ++column) {
                    const auto x = [&](int k) { return bedding.vertices()[index(k, row)].position.x(); };
                    if (p.x() < x(column) || p.x() >= x(column + 1)) {
                        continue;
                    }
                    const float s = (p.x() - x(column)) / (x(column + 1) - x(column));
                    const float t = (z(row) - p.z()) / (z(row) - z(row + 1));
                    const float height = (1 - t) * ((1 - s) * bedding.height(column, row) +
                                                    s * bedding.height(column + 1, row)) +
                                         t * ((1 - s) * bedding.height(column, row + 1) +
                                              s * bedding.height(column + 1, row + 1));
                    depths.deepest = std::max(depths.deepest, p.y() - height);
                    if (p.y() > lowest) {
                        lowest = p.y();
                        depths.of_lowest = p.y() - height;
                    }
                }
            }
        }
        return depths;
    }

    [[nodiscard]] BodyProfile profile() const { return profile_of(outline_.points(scene_)); }

    static std::size_t index(int column, int row) {
        return static_cast<std::size_t>(row * Bedding::columns + column);
    }

    // The facets of a cell of 8 mm lie up to 8^2 / (8 x 45) = 0.2 mm within a head of 45 mm radius, the
    // outline's points up to its own facets above the lowest.
    static constexpr float facets = 1.0e-3f;

    synthetic::Scene source_ = synthetic::make_scene();
    view::SceneView scene_;
    BodyOutline outline_;
};

TEST_F(BeddingTest, CarriesTheBodyWithoutEnteringIt) {
    const BodyProfile body = profile();
    const Bedding bedding(rest_of(body), body);
    const Depths depths = this->depths(bedding);
    EXPECT_GT(depths.of_lowest, -facets) << "it hovers";
    EXPECT_LT(depths.deepest, facets);
}

TEST_F(BeddingTest, FollowsTheHeadAtAnyElevation) {
    const BodyProfile level = profile();
    Bedding bedding(rest_of(level), level);
    for (const float turn : {-10.0f * degree, 15.0f * degree, 30.0f * degree}) {
        for (const float down : {-6e-3f, 0.0f, 4e-3f}) {
            pose_head(turn, down);
            (void)bedding.follow(profile(), -1.0f);
            const Depths depths = this->depths(bedding);
            EXPECT_GT(depths.of_lowest, -2.0f * facets) << turn << " " << down;
            // The outline has a point per 10 mm: flanks of 35 degrees may stand 7 mm deeper beside one.
            EXPECT_LT(depths.deepest, 8e-3f) << turn << " " << down;
        }
    }
}

TEST_F(BeddingTest, ChangesOnlyTheRowsItReports) {
    const BodyProfile level = profile();
    Bedding bedding(rest_of(level), level);
    const std::vector<view::LitVertex> before(bedding.vertices().begin(), bedding.vertices().end());
    pose_head(0.2f, -5e-3f);
    const int rows = bedding.follow(profile(), 0.0f);
    EXPECT_LT(rows, Bedding::rows);
    bool changed = false;
    for (std::size_t k = 0; k < before.size(); ++k) {
        const bool moved = bedding.vertices()[k].position != before[k].position;
        changed = changed || moved;
        EXPECT_FALSE(moved && k >= static_cast<std::size_t>(rows * Bedding::columns)) << k;
    }
    EXPECT_TRUE(changed);
}

TEST_F(BeddingTest, SurfaceFacesUpwards) {
    const BodyProfile body = profile();
    const Bedding bedding(rest_of(body), body);
    for (const Triangle& t : bedding.triangles()) {
        const Vec3f& a = bedding.vertices()[t[0]].position;
        const Vec3f normal =
            (bedding.vertices()[t[1]].position - a).cross(bedding.vertices()[t[2]].position - a);
        EXPECT_LT(normal.y(), 0.0f);
    }
    EXPECT_EQ(4 * bedding.coarse_triangles().size(), bedding.triangles().size());
}

// Beneath the middle of a disc of radius R at the height h the sky is h^2 / (h^2 + R^2).
TEST(SkyBeside, BeneathADisc) {
    BodyProfile disc;
    constexpr float height = 0.03f, radius = 0.055f;
    for (float x = -radius; x <= radius; x += 2e-3f) {
        for (float z = -radius; z <= radius; z += 2e-3f) {
            if (std::hypot(x, z) < radius) {
                disc.add({x, -height, z - 0.2f});
            }
        }
    }
    // Cells of 5 mm, and points that stand for the cells beside theirs, change the radius by up to 8 mm.
    const float more = radius + 8e-3f, less = radius - 8e-3f;
    const float sky = sky_beside(disc, {0, 0, -0.2f});
    EXPECT_GT(sky, height * height / (height * height + more * more));
    EXPECT_LT(sky, height * height / (height * height + less * less));
}

TEST(SkyBeside, InFrontOfAHighWall) {
    BodyProfile wall;
    for (float x = 0.03f; x < 0.19f; x += 4e-3f) {
        for (float z = -0.6f; z < 0.15f; z += 4e-3f) {
            wall.add({x, 0.0f, z});
            wall.add({x, -5.0f, z});
        }
    }
    // Half of the sky; of ten azimuths, those along the wall fall to either side.
    EXPECT_NEAR(sky_beside(wall, {0.01f, 0.0f, -0.2f}), 0.5f, 0.11f);
    EXPECT_FLOAT_EQ(sky_beside(BodyProfile(), {0.0f, 0.0f, -0.2f}), 1.0f);
}

}  // namespace
}  // namespace eti::render
