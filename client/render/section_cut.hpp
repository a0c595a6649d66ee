// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/gl_object.hpp"
#include "client/render/material.hpp"
#include "client/view/skinned_surface.hpp"

namespace eti::render {

struct CutVertex {
    Vec3f position = Vec3f::Zero();
    VertexColour colour{};
};

/// The band of `width` [m] inside the contour along which the plane x = `x` [m] cuts a surface, in the
/// surface's own colour: skin, mucosa and cords keep theirs along the cut. Three entries a triangle.
[[nodiscard]] std::vector<CutVertex> section_band(std::span<const Triangle> triangles,
                                                  std::span<const view::LitVertex> vertices,
                                                  std::span<const VertexColour> colours, float x,
                                                  float width);

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
