// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/triangle_blocks.hpp"

#include <algorithm>
#include <array>
#include <limits>

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

TriangleBlocks::TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest) {
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
        block.first = first;
        block.count = std::min(block_size, triangles_.size() - first);
        // Neighbours share their corners: a vertex belongs to some six triangles.
        std::vector<std::uint32_t> corners;
        for (std::size_t t = first; t < first + block.count; ++t) {
            corners.insert(corners.end(), triangles_[t].begin(), triangles_[t].end());
        }
        std::ranges::sort(corners);
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        block.first_corner = corners_.size();
        block.corner_count = corners.size();
        corners_.insert(corners_.end(), corners.begin(), corners.end());
        blocks_.push_back(block);
    }
}

void TriangleBlocks::update(std::span<const view::LitVertex> vertices) {
    for (Block& block : blocks_) {
        Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
        Vec3f high = -low;
        for (const std::uint32_t v : std::span(corners_).subspan(block.first_corner, block.corner_count)) {
            low = low.cwiseMin(vertices[v].position);
            high = high.cwiseMax(vertices[v].position);
        }
        block.centre = 0.5f * (low + high);
        block.radius = 0.5f * (high - low).norm();
    }
}

std::span<const Triangle> TriangleBlocks::visible(const Eigen::Matrix4f& view_projection, const Vec3f& eye,
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
        const auto first = triangles_.begin() + static_cast<std::ptrdiff_t>(blocks_[seen.block].first);
        order_.insert(order_.end(), first, first + static_cast<std::ptrdiff_t>(blocks_[seen.block].count));
    }
    return order_;
}

}  // namespace eti::render
