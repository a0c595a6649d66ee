// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/triangle_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace eti::render {
namespace {

// Interleaves ten bits of each coordinate: neighbours in space get nearby codes (Morton 1966).
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
        add_block({first, std::min(block_size, triangles_.size() - first)}, rest, skin);
    }
}

void TriangleBlocks::add_block(const Range& range, std::span<const Vec3f> rest,
                               std::span<const SkinWeights> skin) {
    std::vector<std::uint32_t> vertices;
    float longest_edge = 0.0f;
    for (const Triangle& t : std::span(triangles_).subspan(range.first, range.count)) {
        vertices.insert(vertices.end(), t.begin(), t.end());
        for (std::size_t k = 0; k < 3; ++k) {
            longest_edge = std::max(longest_edge, (rest[t[k]] - rest[t[(k + 1) % 3]]).norm());
        }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    Block block;
    block.triangles = range;
    block.longest_edge = longest_edge;
    block.first_carrier = carriers_.size();
    Eigen::AlignedBox3f box;
    std::map<std::uint16_t, std::vector<float>> weights;  // by frame, of the vertices that it influences
    for (const std::uint32_t v : vertices) {
        box.extend(rest[v]);
        std::map<std::uint16_t, float> of_vertex;
        for (std::size_t k = 0; k < skin[v].frame.size(); ++k) {
            of_vertex[skin[v].frame[k]] += skin[v].weight[k];
        }
        for (const auto& [frame, weight] : of_vertex) {
            if (weight > 0.0f) {
                weights[frame].push_back(weight);
            }
        }
    }
    for (auto& [frame, of_frame] : weights) {
        of_frame.resize(vertices.size(), 0.0f);
        Carrier carrier{frame};
        for (const float weight : of_frame) {
            carrier.mean += weight / static_cast<float>(vertices.size());
        }
        for (const float weight : of_frame) {
            carrier.max_deviation = std::max(carrier.max_deviation, std::fabs(weight - carrier.mean));
        }
        carriers_.push_back(carrier);
    }
    block.carrier_count = carriers_.size() - block.first_carrier;
    block.rest_centre = block.centre = box.center();
    for (const std::uint32_t v : vertices) {
        block.rest_radius = std::max(block.rest_radius, (rest[v] - block.rest_centre).norm());
    }
    block.radius = block.rest_radius;
    blocks_.push_back(block);
}

void TriangleBlocks::update(std::span<const FrameMap> frames, const Slack& slack) {
    for (Block& block : blocks_) {
        const auto carriers = std::span(carriers_).subspan(block.first_carrier, block.carrier_count);
        Mat3f linear = Mat3f::Zero();
        block.centre.setZero();
        for (const Carrier& carrier : carriers) {
            linear += carrier.mean * frames[carrier.frame].linear;
            block.centre += carrier.mean * (frames[carrier.frame] * block.rest_centre);
        }
        // Frames rotate and translate: their mean enlarges nothing.
        block.radius = block.rest_radius;
        for (const Carrier& carrier : carriers) {
            const FrameMap& frame = frames[carrier.frame];
            block.radius += carrier.max_deviation * ((frame * block.rest_centre - block.centre).norm() +
                                                     block.rest_radius * (frame.linear - linear).norm());
        }
        if (slack) {
            block.radius += slack(block.centre, block.radius);
        }
    }
}

std::vector<TriangleBlocks::Range> TriangleBlocks::visible(const Eigen::Matrix4f& view_projection,
                                                           const Vec3f& eye, const Eigen::Vector4f& plane,
                                                           const Slack& slack,
                                                           const BlockFilter& which) const {
    // The frustum's planes are sums and differences of the matrix's rows (Gribb & Hartmann 2001).
    std::array<Eigen::Vector4f, 7> planes;
    for (int axis = 0; axis < 3; ++axis) {
        planes[static_cast<std::size_t>(2 * axis)] = view_projection.row(3) + view_projection.row(axis);
        planes[static_cast<std::size_t>(2 * axis + 1)] = view_projection.row(3) - view_projection.row(axis);
    }
    planes[6] = plane;
    std::vector<Seen> seen;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Block& block = blocks_[b];
        const float radius = block.radius + (slack ? slack(block.centre, block.radius) : 0.0f);
        const bool outside = std::any_of(planes.begin(), planes.end(), [&](const Eigen::Vector4f& p) {
            return p.head<3>().dot(block.centre) + p.w() < -radius * p.head<3>().norm();
        });
        if (!outside && (!which || which(block.centre, radius, block.longest_edge))) {
            seen.push_back({(block.centre - eye).norm() - radius, b});
        }
    }
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.block < b.block;
    });
    std::vector<Range> order;
    order.reserve(seen.size());
    for (const Seen& one : seen) {
        order.push_back(blocks_[one.block].triangles);
    }
    return order;
}

TriangleBlocks::CutCandidates TriangleBlocks::cut_candidates(const Eigen::Vector4f& plane) {
    order_.clear();
    Eigen::AlignedBox3f box;
    Vec3f sum = Vec3f::Zero();
    std::size_t count = 0;
    const float length = plane.head<3>().norm();
    for (const Block& block : blocks_) {
        if (std::fabs(plane.head<3>().dot(block.centre) + plane.w()) > block.radius * length) {
            continue;
        }
        sum += static_cast<float>(block.triangles.count) * block.centre;
        count += block.triangles.count;
        box.extend(block.centre - Vec3f::Constant(block.radius));
        box.extend(block.centre + Vec3f::Constant(block.radius));
        if (!order_.empty() && order_.back().first + order_.back().count == block.triangles.first) {
            order_.back().count += block.triangles.count;
        } else {
            order_.push_back(block.triangles);
        }
    }
    return {order_, box, count > 0 ? Vec3f(sum / static_cast<float>(count)) : sum};
}

}  // namespace eti::render
