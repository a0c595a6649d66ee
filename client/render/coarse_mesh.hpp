// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A surface as seen from afar, for shadows: vertices of a cell of `cell` [m] that face the same way become
/// one of them (Rossignac & Borrel 1993), and triangles without area are left out. What faces apart stays
/// apart, or lips that touch at rest would hang together when the mouth opens. It lies within a cell's
/// diagonal of the surface, and moves by the same vertices.
[[nodiscard]] std::vector<Triangle> coarse_triangles(std::span<const Triangle> triangles,
                                                     std::span<const view::LitVertex> rest, float cell);

}  // namespace eti::render
