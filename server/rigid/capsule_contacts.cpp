// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/capsule_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "common/mesh/closest_point.hpp"

namespace eti::rigid {
namespace {

// Sine of angles that count as flat: float positions of a millimetre mesh are accurate to about 1e-4 rad.
constexpr float flat_sine = 1e-3f;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}

Vec3f face_normal(const MeshView& mesh, std::uint32_t triangle) {
    const Triangle& t = mesh.triangles[triangle];
    const Vec3f cross =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    const float norm = cross.norm();
    return norm > 0.0f ? Vec3f(cross / norm) : Vec3f(Vec3f::Zero());
}

// True if moving the mesh point along `towards` does not approach the core point.
bool recedes(const Vec3f& to_core, const Vec3f& towards) {
    return to_core.dot(towards) <= flat_sine * to_core.norm() * towards.norm();
}

bool is_front_and_minimal_at_edge(const MeshView& mesh, std::uint32_t triangle, int edge, const Vec3f& point,
                                  const Vec3f& to_core) {
    Vec3f outward = face_normal(mesh, triangle);
    const std::uint32_t opposite = mesh.topology.across(triangle, edge);
    if (opposite == MeshTopology::none) {
        return to_core.dot(outward) >= 0.0f;
    }
    const Triangle& t = mesh.triangles[triangle];
    const Vec3f& start = mesh.vertices[t[static_cast<std::size_t>(edge)]];
    const Vec3f along = (mesh.vertices[t[static_cast<std::size_t>((edge + 1) % 3)]] - start).normalized();
    Vec3f into = mesh.vertices[opposite] - point;
    into -= along.dot(into) * along;
    if (!recedes(to_core, into)) {
        return false;
    }
    outward += face_normal(mesh, mesh.topology.neighbour(triangle, edge));
    return to_core.dot(outward) > 0.0f;
}

bool is_front_and_minimal_at_vertex(const MeshView& mesh, std::uint32_t vertex, const Vec3f& to_core) {
    Vec3f outward = Vec3f::Zero();
    for (const std::uint32_t triangle : mesh.topology.incident_triangles(vertex)) {
        outward += face_normal(mesh, triangle);
        for (const std::uint32_t other : mesh.triangles[triangle]) {
            if (other != vertex && !recedes(to_core, mesh.vertices[other] - mesh.vertices[vertex])) {
                return false;
            }
        }
    }
    return to_core.dot(outward) > 0.0f;
}

// Only convex or border edges can hold a local minimum of the distance to the core's interior; flat and
// concave ones cannot. An edge shared by two triangles is tested once.
bool edge_can_touch(const MeshView& mesh, std::uint32_t triangle, int edge) {
    const std::uint32_t neighbour = mesh.topology.neighbour(triangle, edge);
    if (neighbour == MeshTopology::none) {
        return true;
    }
    if (neighbour < triangle) {
        return false;
    }
    const Triangle& t = mesh.triangles[triangle];
    const Vec3f across = mesh.vertices[mesh.topology.across(triangle, edge)] -
                         mesh.vertices[t[static_cast<std::size_t>(edge)]];
    return face_normal(mesh, triangle).dot(across) < -flat_sine * across.norm();
}

struct Candidate {
    Vec3f core;
    ClosestPoint closest;
};

void append_if_contact(const Candidate& candidate, float radius, std::uint32_t capsule_index,
                       std::uint32_t triangle, const MeshView& mesh, float margin,
                       std::vector<CapsuleContact>& contacts) {
    const Vec3f to_core = candidate.core - candidate.closest.point;
    const float length = to_core.norm();
    if (length - radius > margin || length < 1e-6f * radius) {
        return;
    }
    switch (candidate.closest.feature) {
        case Feature::face:
            if (to_core.dot(face_normal(mesh, triangle)) <= 0.0f) {
                return;
            }
            break;
        case Feature::edge:
            if (!is_front_and_minimal_at_edge(mesh, triangle, candidate.closest.index,
                                              candidate.closest.point, to_core)) {
                return;
            }
            break;
        case Feature::vertex:
            if (!is_front_and_minimal_at_vertex(
                    mesh, mesh.triangles[triangle][static_cast<std::size_t>(candidate.closest.index)],
                    to_core)) {
                return;
            }
            break;
    }
    const Vec3f normal = to_core / length;
    const float same = 1e-3f * radius;
    for (const CapsuleContact& known : contacts) {
        if (known.capsule == capsule_index &&
            (known.point - candidate.closest.point).squaredNorm() < same * same &&
            known.normal.dot(normal) > 0.9999f) {
            return;
        }
    }
    contacts.push_back({candidate.closest.point, normal, length - radius, triangle, capsule_index});
}

}  // namespace

MeshTopology::MeshTopology(std::span<const Triangle> triangles, std::size_t vertex_count)
    : across_(triangles.size(), {none, none, none}),
      neighbour_(triangles.size(), {none, none, none}),
      ring_first_(vertex_count + 1, 0),
      ring_(triangles.size() * 3) {
    struct Side {
        std::uint32_t triangle;
        std::size_t edge;
    };
    std::unordered_map<std::uint64_t, Side> open;
    open.reserve(triangles.size() * 2);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        for (std::size_t e = 0; e < 3; ++e) {
            ++ring_first_[triangles[i][e] + 1];
            const auto [found, fresh] =
                open.try_emplace(edge_key(triangles[i][e], triangles[i][(e + 1) % 3]), Side{i, e});
            if (!fresh) {
                const Side other = found->second;
                open.erase(found);
                across_[i][e] = triangles[other.triangle][(other.edge + 2) % 3];
                across_[other.triangle][other.edge] = triangles[i][(e + 2) % 3];
                neighbour_[i][e] = other.triangle;
                neighbour_[other.triangle][other.edge] = i;
            }
        }
    }
    for (std::size_t v = 0; v < vertex_count; ++v) {
        ring_first_[v + 1] += ring_first_[v];
    }
    std::vector<std::uint32_t> next(ring_first_.begin(), ring_first_.end() - 1);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        for (const std::uint32_t v : triangles[i]) {
            ring_[next[v]++] = i;
        }
    }
}

void append_contacts(const Capsule& capsule, std::uint32_t capsule_index, std::uint32_t triangle,
                     const MeshView& mesh, float margin, std::vector<CapsuleContact>& contacts) {
    const Triangle& corners = mesh.triangles[triangle];
    const std::array<Vec3f, 3> v = {mesh.vertices[corners[0]], mesh.vertices[corners[1]],
                                    mesh.vertices[corners[2]]};
    const auto try_candidate = [&](const Candidate& candidate) {
        append_if_contact(candidate, capsule.radius, capsule_index, triangle, mesh, margin, contacts);
    };
    try_candidate({capsule.a, closest_on_triangle(capsule.a, v[0], v[1], v[2])});
    if (capsule.a == capsule.b) {
        return;
    }
    try_candidate({capsule.b, closest_on_triangle(capsule.b, v[0], v[1], v[2])});
    const float reach = capsule.radius + margin;
    for (int edge = 0; edge < 3; ++edge) {
        const std::size_t i = static_cast<std::size_t>(edge);
        const std::size_t j = (i + 1) % 3;
        const auto [s, t] = closest_on_segments(capsule.a, capsule.b, v[i], v[j]);
        const Vec3f core = capsule.a + s * (capsule.b - capsule.a);
        if ((core - v[i] - t * (v[j] - v[i])).squaredNorm() > reach * reach ||
            !edge_can_touch(mesh, triangle, edge)) {
            continue;
        }
        ClosestPoint closest{v[i] + t * (v[j] - v[i]), Feature::edge, edge};
        if (t == 0.0f || t == 1.0f) {
            closest = {v[t == 0.0f ? i : j], Feature::vertex, static_cast<int>(t == 0.0f ? i : j)};
        }
        try_candidate({core, closest});
    }
}

}  // namespace eti::rigid
