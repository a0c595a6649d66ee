// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_tracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "common/math/random.hpp"

namespace eti {
namespace {

constexpr float tracks_spacing = 1e-3f, tracks_state = 1.0f / 90.0f;

std::vector<Vec3f> cube_block(int side, float gap = tracks_spacing) {
    std::vector<Vec3f> points;
    for (int k = 0; k < side * side * side; ++k) {
        points.push_back(gap * Eigen::Vector3i(k % side, k / side % side, k / side / side).cast<float>());
    }
    return points;
}

TEST(SpatialHash, FindsAllNeighbours) {
    Random random(3);
    std::vector<Vec3f> points;
    for (int i = 0; i < 400; ++i) {
        points.emplace_back(0.02f * random.uniform() - 0.01f, 0.02f * random.uniform(),
                            0.02f * random.uniform());
    }
    view::SpatialHash cells;
    cells.fill(points, 2e-3f);
    // Reference: all pairs.
    for (const Vec3f& place : points) {
        std::set<std::uint32_t> near, expected;
        std::size_t visits = 0;
        cells.visit_near(place, [&](std::uint32_t i) {
            ++visits;
            if ((points[i] - place).norm() < 2e-3f) {
                near.insert(i);
            }
        });
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if ((points[i] - place).norm() < 2e-3f) {
                expected.insert(i);
            }
        }
        EXPECT_EQ(near, expected);
        EXPECT_LT(visits, points.size()) << "all of them are no search";
    }
}

// Reference: a body that rotates and falls, with known velocities; its particles arrive in a different order
// in each state, as the server's do.
TEST(LiquidTracks, FollowReorderedParticles) {
    const std::vector<Vec3f> rest = cube_block(6);
    const Vec3f turn(0.0f, 0.0f, 8.0f);  // [rad/s]: 60 mm/s at the far corner
    view::LiquidTracks tracks;
    Random random(1);
    Vec3f velocity(0.02f, 0.0f, 0.0f);
    Vec3f shift = Vec3f::Zero();
    std::vector<std::size_t> order(rest.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (int step = 0; step < 30; ++step) {
        const Eigen::Matrix3f rotation =
            Eigen::AngleAxisf(turn.norm() * tracks_state * static_cast<float>(step), Vec3f::UnitZ())
                .toRotationMatrix();
        for (std::size_t k = order.size() - 1; k > 0; --k) {
            std::swap(order[k], order[random.bits() % (k + 1)]);
        }
        std::vector<Vec3f> now;
        for (const std::size_t i : order) {
            now.push_back(rotation * rest[i] + shift);
        }
        tracks.advance(now, tracks_spacing, step == 0 ? 0.0f : tracks_state);
        if (step > 3) {
            for (std::size_t k = 0; k < now.size(); ++k) {
                const Vec3f known = velocity + turn.cross(rotation * rest[order[k]]);
                // Chord against tangent: v turn dt / 2 = 60 mm/s x 0.09 / 2; and the fall of a state.
                EXPECT_LT((tracks.velocities()[k] - known).norm(), 4e-3f) << step;
                ASSERT_NE(tracks.previous_indices()[k], view::LiquidTracks::no_particle);
                EXPECT_EQ(tracks.next_indices()[tracks.previous_indices()[k]], k);
            }
        }
        velocity += tracks_state * Vec3f(0.0f, 0.2f, 0.0f);
        shift += tracks_state * velocity;
    }
}

TEST(LiquidTracks, NewParticleIsNotMatchedToRemovedOne) {
    std::vector<Vec3f> points = cube_block(4);
    view::LiquidTracks tracks;
    tracks.advance(points, tracks_spacing, 0.0f);
    EXPECT_TRUE(std::ranges::all_of(tracks.previous_indices(),
                                    [](auto b) { return b == view::LiquidTracks::no_particle; }));
    const Vec3f far(0.03f, 0.0f, 0.0f);
    points.erase(points.begin() + 5);
    points.push_back(far);
    tracks.advance(points, tracks_spacing, tracks_state);
    EXPECT_EQ(tracks.next_indices()[5], view::LiquidTracks::no_particle);
    EXPECT_EQ(tracks.previous_indices().back(), view::LiquidTracks::no_particle);
    EXPECT_EQ(tracks.velocities().back(), Vec3f(Vec3f::Zero()));
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        EXPECT_EQ(tracks.previous_indices()[i], i < 5 ? i : i + 1);
    }
}

}  // namespace
}  // namespace eti
