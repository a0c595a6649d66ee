// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <cstdint>
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
    static constexpr std::size_t block_size = 96;  ///< triangles

    /// Neighbours in triangles().
    struct Range {
        std::size_t first = 0, count = 0;
    };

    TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest,
                   std::span<const SkinWeights> skin);

    /// Sorted into blocks: for an index buffer that stays.
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

    /// New bounding balls. A vertex lies in the hull of what its frames make of it; so does a block in that
    /// of what its frames make of its ball. `slack` [m]: by how much vertices may be moved beyond that.
    void update(std::span<const FrameMap> frames, float slack = 0.0f);

    /// The blocks that reach into the frustum of `view_projection` and beyond the plane
    /// dot(plane.xyz, p) + plane.w >= 0, in order of their distance from `eye` [m].
    [[nodiscard]] std::span<const Range> visible(const Eigen::Matrix4f& view_projection, const Vec3f& eye,
                                                 const Eigen::Vector4f& plane);

  private:
    struct Block {
        Vec3f rest_centre = Vec3f::Zero(), centre = Vec3f::Zero();
        float rest_radius = 0.0f, radius = 0.0f;
        Range triangles;
        std::size_t first_frame = 0, frame_count = 0;  // in frames_
    };
    struct Seen {
        float distance;
        std::size_t block;
    };

    std::vector<Triangle> triangles_;
    std::vector<std::uint16_t> frames_;  // that carry each block, each once
    std::vector<Block> blocks_;
    std::vector<Seen> seen_;
    std::vector<Range> order_;
};

}  // namespace eti::render
