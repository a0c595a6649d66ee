// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::rigid {

/// Contact of a capsule with a triangle that it is near or penetrates. Units are those of the input.
struct CapsuleContact {
    Vec3f point = Vec3f::Zero();    ///< on the triangle
    Vec3f normal = Vec3f::UnitZ();  ///< unit, from the triangle to the capsule's core
    float distance = 0.0f;          ///< to the capsule's surface; negative when penetrating
    std::uint32_t triangle = 0;
    std::uint32_t capsule = 0;
};

/// Triangle adjacency of a mesh across edges and vertices; independent of positions.
class MeshTopology {
  public:
    MeshTopology() = default;
    MeshTopology(std::span<const Triangle> triangles, std::size_t vertex_count);

    static constexpr std::uint32_t none = 0xffffffffu;

    /// The vertex opposite edge `edge` (from corner `edge` to the next) of `triangle`; `none` at a border.
    [[nodiscard]] std::uint32_t across(std::uint32_t triangle, int edge) const {
        return across_[triangle][static_cast<std::size_t>(edge)];
    }
    /// The triangle across that edge; `none` at a border.
    [[nodiscard]] std::uint32_t neighbour(std::uint32_t triangle, int edge) const {
        return neighbour_[triangle][static_cast<std::size_t>(edge)];
    }
    [[nodiscard]] std::span<const std::uint32_t> incident_triangles(std::uint32_t vertex) const {
        return std::span(ring_).subspan(ring_first_[vertex], ring_first_[vertex + 1] - ring_first_[vertex]);
    }

  private:
    std::vector<std::array<std::uint32_t, 3>> across_;
    std::vector<std::array<std::uint32_t, 3>> neighbour_;
    std::vector<std::uint32_t> ring_first_;
    std::vector<std::uint32_t> ring_;  // triangles around each vertex
};

struct MeshView {
    std::span<const Vec3f> vertices;
    std::span<const Triangle> triangles;
    const MeshTopology& topology;
};

/// Appends the contacts of `capsule` with one triangle whose distance is below `margin`.
///
/// A contact is a pair of a core point p and a mesh point q, where q is a local minimum over the whole mesh
/// of the distance to p. Pairs that are a minimum on their own triangle only (the internal edges that a
/// sliding body catches on) are left out, because a neighbour supplies the nearer pair. Triangles are
/// one-sided: they act on their front.
///
/// Candidate core points are the core's ends and the points nearest to the triangle's convex and border
/// edges. They include every local minimum of the pair, and both ends of a capsule that lies flat.
void append_contacts(const Capsule& capsule, std::uint32_t capsule_index, std::uint32_t triangle,
                     const MeshView& mesh, float margin, std::vector<CapsuleContact>& contacts);

}  // namespace eti::rigid
