// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Whether segment pq passes through the inside of triangle abc. Touching an edge, a vertex or the
/// plane without crossing does not count; a segment in the triangle's plane does not either.
[[nodiscard]] bool crosses(const Vec3f& p, const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Pairs of triangles (lower index first, sorted) of which one's edge passes through the other.
/// Neighbours that share an edge cannot cross, only fold back; that is not looked for. With `asked`, a flag a
/// triangle, only pairs with a triangle that is asked for, at a cost that grows with their number.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> self_intersections(
    const TriangleMesh& mesh, std::span<const std::uint8_t> asked = {});

}  // namespace eti
