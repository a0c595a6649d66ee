// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/material.hpp"
#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A modelled, rigid, closed mesh. The fourth byte of a colour is its gloss: 0 cotton, 255 polished.
struct Solid {
    std::vector<view::LitVertex> vertices;
    std::vector<VertexColour> colours;
    std::vector<Triangle> triangles;

    /// Adds a part, moved by `pose`.
    void append(const Solid& part, const RigidTransform& pose = {});
};

/// A box with edges rounded over `radius` [m] by one bevel, about `centre` [m].
[[nodiscard]] Solid rounded_box(const Vec3f& centre, const Vec3f& half, float radius, VertexColour colour);

/// A circular section of a sweep.
struct Ring {
    Vec3f centre = Vec3f::Zero();  ///< [m]
    float radius = 0.0f;           ///< [m]
};

/// A surface swept along at least two rings, with flat ends; the sections are perpendicular to the path and
/// do not twist.
[[nodiscard]] Solid sweep(std::span<const Ring> path, std::uint32_t sides, VertexColour colour);

/// Points of a Catmull-Rom spline [m] through `through`, `steps` per span.
[[nodiscard]] std::vector<Vec3f> spline(std::span<const Vec3f> through, int steps);

/// A hose of constant radius [m] along a spline.
[[nodiscard]] Solid hose(std::span<const Vec3f> through, float radius, VertexColour colour);

}  // namespace eti::render
