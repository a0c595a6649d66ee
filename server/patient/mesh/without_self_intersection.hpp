// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/simplify.hpp"
#include "server/patient/mesh/smooth.hpp"

namespace eti {

/// Like smooth(), but leaves the surface unsmoothed where smoothing would make it intersect itself: the
/// surface of marching tetrahedra has no self-intersections.
void smooth_without_self_intersection(TriangleMesh& mesh, int iterations);

/// Like simplify(), but relaxes vertices towards their neighbours where the coarse surface intersects itself
/// and, if that fails, keeps the surface finer there. Remaining self-intersections are left for check().
/// Without self-intersections the result equals simplify().
[[nodiscard]] TriangleMesh simplify_without_self_intersection(const TriangleMesh& mesh,
                                                              const SimplifySettings& settings);

}  // namespace eti
