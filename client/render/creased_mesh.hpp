// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <vector>

#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A rigid mesh whose vertices were multiplied where its faces meet in an edge.
struct CreasedMesh {
    std::vector<view::LitVertex> vertices;
    std::vector<Triangle> triangles;
};

/// Smooth where neighbouring faces differ by less than `angle` [rad], sharp where by more: tools have
/// edges that a mean normal would smear over their faces.
[[nodiscard]] CreasedMesh creased(const TriangleMesh& mesh, float angle);

/// The same surface with every edge halved that is longer than `longest` says [m] at its middle, until none
/// is. Triangles of an edge agree, so that no gap opens between them.
[[nodiscard]] CreasedMesh with_edges_of(CreasedMesh mesh, const std::function<float(const Vec3f&)>& longest);

}  // namespace eti::render
