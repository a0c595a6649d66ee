// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/tube_connector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/math/units.hpp"

namespace eti::render {
namespace {

constexpr std::uint32_t connector_sides = 24;
constexpr float lug = 0.28f;  // of the flange's radius

struct ProfilePoint {
    float z, radius;  // [mm], z towards the tube's tip
    float lugs;       // share of the lugs' length
};

}  // namespace

TubeConnector make_tube_connector(const Tube& tube) {
    const float outer = tube.outer_radius() / millimetre, inner = tube.inner_radius() / millimetre;
    const float neck = 1.3f * outer, bore = 0.8f * inner;
    // Once round the longitudinal section: from the free end down the outside, and back through the bore.
    const std::array<ProfilePoint, 19> profile{{{-28.0f, 6.4f, 0},
                                                {-28.0f, 7.2f, 0},
                                                {-27.6f, 7.45f, 0},
                                                {-9.6f, 7.9f, 0},
                                                {-9.0f, 8.0f, 0},
                                                {-9.0f, 9.4f, 1},
                                                {-8.7f, 9.7f, 1},
                                                {-7.6f, 9.7f, 1},
                                                {-7.3f, 9.4f, 1},
                                                {-7.3f, 5.0f, 0},
                                                {-6.6f, 4.0f, 0},
                                                {-2.2f, neck, 0},
                                                {-1.7f, neck + 0.35f, 0},
                                                {-1.0f, neck + 0.35f, 0},
                                                {-0.1f, 1.12f * outer, 0},
                                                {0.6f, 1.02f * outer, 0},
                                                {0.6f, bore, 0},
                                                {-6.0f, bore, 0},
                                                {-12.0f, 6.1f, 0}}};
    TubeConnector mesh;
    const auto point = [&](const ProfilePoint& at, std::uint32_t side) {
        const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / connector_sides;
        const float across = std::cos(turn) * std::cos(turn);
        const float radius = at.radius * (1.0f + at.lugs * lug * across * across);
        return Vec3f(millimetre * Vec3f(radius * std::cos(turn), radius * std::sin(turn), at.z));
    };
    for (std::size_t k = 0; k < profile.size(); ++k) {
        const ProfilePoint &a = profile[k], &b = profile[(k + 1) % profile.size()];
        const Eigen::Vector2f slope = Eigen::Vector2f(b.z - a.z, a.radius - b.radius).normalized();
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const ProfilePoint& end : {a, b}) {
            for (std::uint32_t side = 0; side < connector_sides; ++side) {
                const float around = static_cast<float>(side) / connector_sides;
                const float turn = 2.0f * std::numbers::pi_v<float> * around;
                const Vec3f normal(slope.x() * std::cos(turn), slope.x() * std::sin(turn), slope.y());
                mesh.vertices.push_back(
                    {point(end, side), normal, tube.length + 1e-3f - millimetre * (end.z - 1.0f), around});
            }
        }
        for (std::uint32_t side = 0; side < connector_sides; ++side) {
            const std::uint32_t next = (side + 1) % connector_sides, second = first + connector_sides;
            mesh.triangles.push_back({first + side, first + next, second + side});
            mesh.triangles.push_back({first + next, second + next, second + side});
        }
    }
    return mesh;
}

}  // namespace eti::render
