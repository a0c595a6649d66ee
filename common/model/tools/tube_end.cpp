// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/tube_end.hpp"

namespace eti {

// A small anterior component keeps the side of a nearly straight tube from flipping.
Vec3f concave_side(std::span<const Vec3f> nodes, const Vec3f& tangent) {
    Vec3f bend = 1e-4f * -Vec3f::UnitY();
    for (std::size_t i = 1; i + 1 < nodes.size(); ++i) {
        bend += nodes[i - 1] - 2.0f * nodes[i] + nodes[i + 1];
    }
    Vec3f side = bend - bend.dot(tangent) * tangent;
    if (side.norm() < 1e-7f) {
        side = tangent.unitOrthogonal();
    }
    return side.normalized();
}

std::optional<TubeEnd> tube_end(std::span<const Vec3f> nodes, float radius) {
    // A round end of the preceding part stays within the tube: the bevel reaches back two radii.
    const float length = (1.0f + 2.0f * bevel_slope) * radius;
    constexpr float apart = 1e-6f;  // [m]
    if (nodes.size() < 2) {
        return std::nullopt;
    }
    TubeEnd end{.nodes = nodes.size() - 1, .start = nodes.back(), .tip = nodes.back()};
    for (float left = length; left > 0.0f && end.nodes > 0; --end.nodes) {
        const Vec3f back = nodes[end.nodes - 1] - end.start;
        const float step = back.norm();
        if (step > left) {
            end.start += left / step * back;
            break;
        }
        end.start = nodes[end.nodes - 1];
        left -= step;
    }
    const Vec3f whole = end.tip - end.start;
    if (whole.norm() < apart) {
        return std::nullopt;
    }
    // Parallel transport along the tube, without twist.
    Vec3f across = Vec3f::Zero(), along = Vec3f::Zero();
    bool begun = false;
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        const Vec3f step = nodes[i] - nodes[i - 1];
        if (step.norm() < apart) {
            continue;
        }
        along = step.normalized();
        const Vec3f carried = begun ? Vec3f(across - across.dot(along) * along) : concave_side(nodes, along);
        across = carried.norm() > 1e-6f ? carried.normalized() : along.unitOrthogonal();
        begun = true;
    }
    along = whole.normalized();
    end.bevel = along + bevel_slope * across.cross(along).normalized();
    end.beyond = -bevel_slope * radius;
    return end;
}

}  // namespace eti
