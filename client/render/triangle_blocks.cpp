// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/triangle_blocks.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <Eigen/Geometry>

namespace eti::render {
namespace {

// Ten bits of each coordinate interleaved: neighbours in space get neighbouring numbers (Morton 1966).
std::uint32_t morton(const Vec3f& unit) {
    const auto spread = [](float value) {
        std::uint32_t bits = static_cast<std::uint32_t>(std::clamp(value, 0.0f, 1.0f) * 1023.0f);
        bits = (bits | (bits << 16)) & 0x030000ffu;
        bits = (bits | (bits << 8)) & 0x0300f00fu;
        bits = (bits | (bits << 4)) & 0x030c30c3u;
        return (bits | (bits << 2)) & 0x09249249u;
    };
    return spread(unit.x()) | (spread(unit.y()) << 1) | (spread(unit.z()) << 2);
}

}  // namespace

TriangleBlocks::TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest,
                               std::span<const SkinWeights> skin) {
    Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
    Vec3f high = -low;
    for (const Vec3f& p : rest) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const float side = std::max((high - low).maxCoeff(), 1e-6f);
    std::vector<std::pair<std::uint32_t, Triangle>> keyed;
    keyed.reserve(triangles.size());
    for (const Triangle& t : triangles) {
        const Vec3f centre = (rest[t[0]] + rest[t[1]] + rest[t[2]]) / 3.0f;
        keyed.emplace_back(morton((centre - low) / side), t);
    }
    std::stable_sort(keyed.begin(), keyed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [key, triangle] : keyed) {
        triangles_.push_back(triangle);
    }
    for (std::size_t first = 0; first < triangles_.size(); first += block_size) {
        Block block;
        block.triangles = {first, std::min(block_size, triangles_.size() - first)};
        block.first_frame = frames_.size();
        Eigen::AlignedBox3f box;
        for (const Triangle& t : std::span(triangles_).subspan(first, block.triangles.count)) {
            for (const std::uint32_t v : t) {
                box.extend(rest[v]);
                for (std::size_t k = 0; k < skin[v].frame.size(); ++k) {
                    if (skin[v].weight[k] > 0.0f) {
                        frames_.push_back(skin[v].frame[k]);
                    }
                }
            }
        }
        const auto begin = frames_.begin() + static_cast<std::ptrdiff_t>(block.first_frame);
        std::sort(begin, frames_.end());
        frames_.erase(std::unique(begin, frames_.end()), frames_.end());
        block.frame_count = frames_.size() - block.first_frame;
        block.rest_centre = block.centre = box.center();
        block.rest_radius = block.radius = 0.5f * box.diagonal().norm();
        blocks_.push_back(block);
    }
}

void TriangleBlocks::update(std::span<const FrameMap> frames, float slack) {
    for (Block& block : blocks_) {
        Eigen::AlignedBox3f centres;
        for (const std::uint16_t f : std::span(frames_).subspan(block.first_frame, block.frame_count)) {
            centres.extend(frames[f] * block.rest_centre);
        }
        block.centre = centres.center();
        // Frames turn and shift, so that the ball keeps its size.
        block.radius = 0.5f * centres.diagonal().norm() + block.rest_radius + slack;
    }
}

std::span<const TriangleBlocks::Range> TriangleBlocks::visible(const Eigen::Matrix4f& view_projection,
                                                               const Vec3f& eye,
                                                               const Eigen::Vector4f& plane) {
    // The frustum's planes are sums and differences of the matrix's rows (Gribb & Hartmann 2001).
    std::array<Eigen::Vector4f, 7> planes;
    for (int axis = 0; axis < 3; ++axis) {
        planes[static_cast<std::size_t>(2 * axis)] = view_projection.row(3) + view_projection.row(axis);
        planes[static_cast<std::size_t>(2 * axis + 1)] = view_projection.row(3) - view_projection.row(axis);
    }
    planes[6] = plane;
    seen_.clear();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Block& block = blocks_[b];
        const bool outside = std::any_of(planes.begin(), planes.end(), [&](const Eigen::Vector4f& p) {
            return p.head<3>().dot(block.centre) + p.w() < -block.radius * p.head<3>().norm();
        });
        if (!outside) {
            seen_.push_back({(block.centre - eye).norm() - block.radius, b});
        }
    }
    std::sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.block < b.block;
    });
    order_.clear();
    for (const Seen& seen : seen_) {
        order_.push_back(blocks_[seen.block].triangles);
    }
    return order_;
}

}  // namespace eti::render
