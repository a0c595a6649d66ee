// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A skinned mesh's triangles in blocks of neighbours with bounding balls, so that a view draws only the
/// blocks it can see, nearest first: on a software rasteriser pixels hidden by what was drawn before
/// cost a tenth of shaded ones.
class TriangleBlocks {
  public:
    static constexpr std::size_t block_size = 32;  ///< triangles

    /// Neighbours in triangles().
    struct Range {
        std::size_t first = 0, count = 0;
    };

    TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest,
                   std::span<const SkinWeights> skin);

    /// Sorted into blocks: for an index buffer that stays.
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

    /// By how much [m] vertices within a ball may lie elsewhere than their frames have them.
    using Slack = std::function<float(const Vec3f& centre, float radius)>;

    /// `longest_edge`: of a block's triangles at rest [m].
    using Which = std::function<bool(const Vec3f& centre, float radius, float longest_edge)>;

    /// New bounding balls. A vertex is sum(w_i F_i(p)) over its frames. Of the block's mean weights W_i that
    /// is the mean map M(p), which shifts the ball, and sum((w_i - W_i) (F_i(p) - M(p))): what the ball grows
    /// by is bounded by how far weights and frames lie from their means.
    void update(std::span<const FrameMap> frames, const Slack& slack = {});

    /// The blocks that reach into the frustum of `view_projection` and beyond the plane
    /// dot(plane.xyz, p) + plane.w >= 0, in order of their distance from `eye` [m]. `slack`: in this view;
    /// `which`: only those.
    [[nodiscard]] std::vector<Range> visible(const Eigen::Matrix4f& view_projection, const Vec3f& eye,
                                             const Eigen::Vector4f& plane, const Slack& slack = {},
                                             const Which& which = {}) const;

    struct NearPlane {
        std::span<const Range> ranges;
        Eigen::AlignedBox3f box;  ///< around them [m]
        Vec3f middle;             ///< of them [m]
    };
    /// The blocks that a plane may cut.
    [[nodiscard]] NearPlane near_plane(const Eigen::Vector4f& plane);

  private:
    struct Block {
        Vec3f rest_centre = Vec3f::Zero(), centre = Vec3f::Zero();
        float rest_radius = 0.0f, radius = 0.0f, longest_edge = 0.0f;
        Range triangles;
        std::size_t first_carrier = 0, carrier_count = 0;  // in carriers_
    };
    // A frame that carries vertices of a block, and its weights in them.
    struct Carrier {
        std::uint16_t frame;
        float mean = 0.0f, most_apart = 0.0f;
    };
    struct Seen {
        float distance;
        std::size_t block;
    };

    void add_block(const Range& range, std::span<const Vec3f> rest, std::span<const SkinWeights> skin);

    std::vector<Triangle> triangles_;
    std::vector<Carrier> carriers_;  // of each block, each once
    std::vector<Block> blocks_;
    std::vector<Range> order_;
};

}  // namespace eti::render
