// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Whether segment pq passes through the interior of triangle abc. Touching an edge, a vertex or the plane
/// without crossing does not count, nor does a segment in the triangle's plane.
[[nodiscard]] bool crosses(const Vec3f& p, const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Pairs of triangles (lower index first, sorted) where an edge of one passes through the other. Neighbours
/// that share an edge can only fold back, which is not tested. `asked`, one flag per triangle, restricts the
/// search to pairs with a flagged triangle, at a cost proportional to their number.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> self_intersections(
    const TriangleMesh& mesh, std::span<const std::uint8_t> asked = {});

}  // namespace eti
