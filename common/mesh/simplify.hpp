// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>
#include <span>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

struct SimplifySettings {
    std::size_t triangles = 10000;  ///< budget; collapses stop at this number
    /// [m]; collapses stop where the root mean square distance to the original planes would exceed it.
    float max_error = std::numeric_limits<float>::infinity();
    /// Error weight per vertex; may be empty. A weight of 100 makes triangles about ten times smaller in
    /// area, since the error grows with the square of the area.
    std::span<const float> importance{};
};

/// Quadric-error edge collapse (Garland & Heckbert, SIGGRAPH 1997). The link condition (Dey et al. 1999)
/// keeps a closed manifold closed and manifold with the same genus. Collapses that would turn a triangle's
/// normal by more than about 70 degrees or flatten it to a sliver are rejected. Vertices on open or
/// non-manifold edges do not move. The mesh must be oriented consistently. The result may exceed the budget
/// when no valid collapse is left.
[[nodiscard]] TriangleMesh simplify(const TriangleMesh& mesh, const SimplifySettings& settings);

}  // namespace eti
