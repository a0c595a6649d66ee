// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/gl_object.hpp"
#include "client/render/material.hpp"
#include "client/render/vantage.hpp"
#include "client/view/skinned_surface.hpp"

namespace eti::render {

struct CutVertex {
    Vec3f position = Vec3f::Zero();
    VertexColour colour{};
};

/// Where a plane cuts a triangle.
struct CutSegment {
    struct End {
        Vec3f position = Vec3f::Zero();  ///< [m], in the plane
        Vec3f inward = Vec3f::Zero();    ///< unit, in the plane; zero where the surface lies in it
        VertexColour colour{};
    };
    End a, b;
};

/// The contour along which a plane cuts a surface; closed where the surface is.
[[nodiscard]] std::vector<CutSegment> section_contour(std::span<const Triangle> triangles,
                                                      std::span<const view::LitVertex> vertices,
                                                      std::span<const VertexColour> colours,
                                                      const CutPlane& plane);

/// The band of `width` [m] inside a contour in the surface's own colour: skin, mucosa and cords keep theirs
/// along the cut. Three entries a triangle.
[[nodiscard]] std::vector<CutVertex> section_band(std::span<const CutSegment> contour, float width);

/// Triangles from one point to each segment of a contour: a place lies inside the contour where an odd number
/// of them cover it.
[[nodiscard]] std::vector<CutVertex> section_fan(std::span<const CutSegment> contour);

/// Draws loose triangles of CutVertex.
class CutMesh {
  public:
    CutMesh();
    void draw(std::span<const CutVertex> vertices) const;

  private:
    VertexArray array_;
    Buffer vertices_;
};

}  // namespace eti::render
