// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// Simplified surface for shadows: vertices within a cell of `cell` [m] whose normals have equal signs are
/// merged (Rossignac & Borrel 1993), and degenerate triangles removed. Vertices that face apart stay
/// separate; otherwise lips that touch at rest would stay joined when the mouth opens. The result lies
/// within a cell's diagonal of the surface and uses the same vertices.
[[nodiscard]] std::vector<Triangle> coarse_triangles(std::span<const Triangle> triangles,
                                                     std::span<const view::LitVertex> rest, float cell);

}  // namespace eti::render
