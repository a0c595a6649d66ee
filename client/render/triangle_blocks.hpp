// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A mesh's triangles in blocks of neighbours with bounding balls, so that a view draws only the
/// blocks it can see, nearest first: on a software rasteriser pixels hidden by what was drawn before
/// cost a tenth of shaded ones.
class TriangleBlocks {
  public:
    static constexpr std::size_t block_size = 96;  ///< triangles

    TriangleBlocks(std::span<const Triangle> triangles, std::span<const Vec3f> rest);

    /// New bounding balls for the current shape.
    void update(std::span<const view::LitVertex> vertices);

    /// Triangles of the blocks that reach into the frustum of `view_projection` and beyond the plane
    /// dot(plane.xyz, p) + plane.w >= 0, in order of their distance from `eye` [m].
    [[nodiscard]] std::span<const Triangle> visible(const Eigen::Matrix4f& view_projection, const Vec3f& eye,
                                                    const Eigen::Vector4f& plane);

  private:
    struct Block {
        Vec3f centre = Vec3f::Zero();
        float radius = 0.0f;
        std::size_t first = 0, count = 0;                // in triangles_
        std::size_t first_corner = 0, corner_count = 0;  // in corners_
    };
    struct Seen {
        float distance;
        std::size_t block;
    };

    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> corners_;  // vertices of each block, each once
    std::vector<Block> blocks_;
    std::vector<Seen> seen_;
    std::vector<Triangle> order_;
};

}  // namespace eti::render
