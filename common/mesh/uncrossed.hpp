// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/simplify.hpp"
#include "common/mesh/smooth.hpp"

namespace eti {

/// smooth(), but places where smoothing makes the surface cross itself stay as they were: marching
/// tetrahedra's surface never crosses itself.
void smooth_without_crossing(TriangleMesh& mesh, int iterations);

/// simplify(); where the coarse surface crosses itself, its vertices are relaxed towards their neighbours,
/// and where that does not help, the surface stays finer there. What still crosses after that is left, for
/// check() to find. Without crossings the result is that of simplify().
[[nodiscard]] TriangleMesh simplify_without_crossing(const TriangleMesh& mesh,
                                                     const SimplifySettings& settings);

}  // namespace eti
