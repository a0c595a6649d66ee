// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Taubin's low-pass filter (SIGGRAPH 1995): each iteration shrinks by `lambda` towards the mean of the
/// neighbours, then inflates by `mu`. It removes the grid's staircase and preserves volume: the gain is (1 -
/// lambda k)(1 - mu k) for eigenvalue k of the umbrella operator, one at k = 1 / lambda + 1 / mu. The mesh
/// must be closed.
void smooth(TriangleMesh& mesh, int iterations, float lambda = 0.5f, float mu = -0.53f);

}  // namespace eti
