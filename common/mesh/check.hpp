// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Validity and topology of a triangle mesh.
struct MeshReport {
    std::size_t vertices = 0;  ///< used by at least one triangle
    std::size_t triangles = 0;
    std::size_t open_edges = 0;         ///< used by one triangle
    std::size_t nonmanifold_edges = 0;  ///< used by more than two
    std::size_t misoriented_edges = 0;  ///< traversed in the same direction by two triangles
    std::size_t pinched_vertices = 0;   ///< whose triangles form more than one fan
    std::size_t degenerate_triangles =
        0;  ///< a repeated vertex, or an area below 1e-6 of the longest side squared
    std::size_t self_intersections = 0;  ///< pairs of triangles that cross
    std::optional<Vec3f> fault_at;       ///< [m], location of one of the faults
    std::size_t components = 0;
    long euler_characteristic = 0;  ///< 2 (components - handles) for a closed mesh
    double volume = 0.0;            ///< [m^3], positive when oriented outwards
    double area = 0.0;              ///< [m^2]

    /// Closed, oriented 2-manifold without degenerate triangles or self-intersections.
    [[nodiscard]] bool is_valid() const {
        return open_edges + nonmanifold_edges + misoriented_edges + pinched_vertices + degenerate_triangles +
                       self_intersections ==
                   0 &&
               triangles > 0;
    }

    /// One line with all counts, for logs and test messages.
    [[nodiscard]] std::string describe() const;
};

/// Examines a mesh; about 1 s for a million triangles, most of it the search for self-intersections.
[[nodiscard]] MeshReport check(const TriangleMesh& mesh);

}  // namespace eti
