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

/// A skinned mesh's triangles in blocks of neighbours with bounding spheres, so that a view draws only
/// visible blocks, nearest first: on a software rasteriser a hidden pixel costs a tenth of a shaded one.
class TriangleBlocks {
  public:
    static constexpr std::size_t block_size = 32;  ///< triangles

    /// A contiguous range in triangles().
    struct Range {
        std::size_t first = 0, count = 0;
    };

    TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest,
                   std::span<const SkinWeights> skin);

    /// Sorted into blocks, for a constant index buffer.
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

    /// Upper bound [m] of the displacement of vertices within a sphere from their skinned positions.
    using Slack = std::function<float(const Vec3f& centre, float radius)>;

    /// `longest_edge`: of the block's triangles at rest [m].
    using BlockFilter = std::function<bool(const Vec3f& centre, float radius, float longest_edge)>;

    /// Updates the bounding spheres. A vertex is sum(w_i F_i(p)) over its frames. With the block's mean
    /// weights W_i this is the mean map M(p), which moves the sphere, plus sum((w_i - W_i) (F_i(p) -
    /// M(p))). The sphere's growth is bounded by the deviations of weights and frames from their means.
    void update(std::span<const FrameMap> frames, const Slack& slack = {});

    /// The blocks that intersect the frustum of `view_projection` and the half-space dot(plane.xyz, p) +
    /// plane.w >= 0, in order of distance from `eye` [m]. `slack`: displacement bound in this view;
    /// `which`: filter.
    [[nodiscard]] std::vector<Range> visible(const Eigen::Matrix4f& view_projection, const Vec3f& eye,
                                             const Eigen::Vector4f& plane, const Slack& slack = {},
                                             const BlockFilter& which = {}) const;

    struct CutCandidates {
        std::span<const Range> ranges;
        Eigen::AlignedBox3f box;  ///< bounding box [m]
        Vec3f middle;             ///< centre of the box [m]
    };
    /// The blocks that a plane may intersect.
    [[nodiscard]] CutCandidates cut_candidates(const Eigen::Vector4f& plane);

  private:
    struct Block {
        Vec3f rest_centre = Vec3f::Zero(), centre = Vec3f::Zero();
        float rest_radius = 0.0f, radius = 0.0f, longest_edge = 0.0f;
        Range triangles;
        std::size_t first_carrier = 0, carrier_count = 0;  // range in carriers_
    };
    // A frame that influences vertices of a block, with its weights.
    struct Carrier {
        std::uint16_t frame;
        float mean = 0.0f, max_deviation = 0.0f;
    };
    struct Seen {
        float distance;
        std::size_t block;
    };

    void add_block(const Range& range, std::span<const Vec3f> rest, std::span<const SkinWeights> skin);

    std::vector<Triangle> triangles_;
    std::vector<Carrier> carriers_;  // by block, without duplicates
    std::vector<Block> blocks_;
    std::vector<Range> order_;
};

}  // namespace eti::render
