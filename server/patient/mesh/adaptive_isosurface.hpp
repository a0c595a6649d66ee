// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <span>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// A scalar field with a local resolution. Both functions may be called from several threads, and may
/// parallelise over many points.
struct AdaptiveField {
    Vec3f low = Vec3f::Zero(), high = Vec3f::Zero();  ///< [m], corners of the sampled box
    /// [m], negative inside. Approximately a distance: cells far from the surface stay coarse because of it.
    std::function<void(std::span<const Vec3f>, std::span<float>)> value;
    /// [m], cell edge at a point of the surface. Should change by less than 0.4 m per m.
    std::function<float(const Vec3f&)> edge;
    float coarsest = 8e-3f;  ///< [m], edge of the initial cubes
    int max_bisections = 6;  ///< maximum number of bisections of a cube's edge
};

/// The zero isosurface by marching tetrahedra over adaptively bisected tetrahedra (newest vertex bisection of
/// Freudenthal's six per cube; Maubach 1995, SIAM J Sci Comput 16:210). Neighbours are bisected until the
/// mesh is conforming, so that the surface is closed, manifold and free of self-intersections for any field.
/// A solid that reaches the box's border is capped there, within a cell.
[[nodiscard]] TriangleMesh adaptive_isosurface(const AdaptiveField& field);

}  // namespace eti
