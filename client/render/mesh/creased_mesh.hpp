// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <vector>

#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A rigid mesh whose vertices are duplicated along sharp edges.
struct CreasedMesh {
    std::vector<view::LitVertex> vertices;
    std::vector<Triangle> triangles;
};

/// Smooth where neighbouring faces differ by less than `angle` [rad], sharp otherwise: averaged normals
/// would blur the edges of tools.
[[nodiscard]] CreasedMesh creased(const TriangleMesh& mesh, float angle);

/// Splits edges longer than `longest` [m] at their midpoint until none remain. Triangles that share an edge
/// split it alike, so that no gap opens between them.
[[nodiscard]] CreasedMesh subdivide_long_edges(CreasedMesh mesh,
                                               const std::function<float(const Vec3f&)>& longest);

}  // namespace eti::render
