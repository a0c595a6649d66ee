// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <span>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// A field that is as fine in some places as they ask for. Both functions may be called with many points and
/// may work on them in parallel.
struct AdaptiveField {
    Vec3f low = Vec3f::Zero(), high = Vec3f::Zero();  ///< [m], corners of the box that is looked at
    /// [m], negative inside. About a distance: cells far from the surface stay coarse by it.
    std::function<void(std::span<const Vec3f>, std::span<float>)> value;
    /// [m], edges of cells at a point of the surface. Should change by less than 0.4 m per m.
    std::function<float(const Vec3f&)> edge;
    float coarsest = 8e-3f;  ///< [m], edge of the cubes that are divided
    int halvings = 6;        ///< most of them that a cube's edge goes through
};

/// The surface where the field is zero, by marching tetrahedra over tetrahedra that are bisected until they
/// are fine enough (newest vertex bisection of Freudenthal's six in a cube; Maubach 1995, SIAM J Sci Comput
/// 16:210). Neighbours are bisected along until no vertex hangs on an edge, so that the mesh is closed,
/// manifold and free of crossings whatever the fields are. A solid that reaches the box's border is capped
/// there, within a cell.
[[nodiscard]] TriangleMesh adaptive_isosurface(const AdaptiveField& field);

}  // namespace eti
