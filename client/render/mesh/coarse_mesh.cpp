// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/coarse_mesh.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

namespace eti::render {
namespace {

// Cell index and signs of the normal.
using Key = std::array<int, 4>;

Key key_of(const view::LitVertex& vertex, float cell) {
    const auto along = [&](int axis) { return static_cast<int>(std::floor(vertex.position[axis] / cell)); };
    const int octant = (vertex.normal.x() < 0.0f ? 1 : 0) + (vertex.normal.y() < 0.0f ? 2 : 0) +
                       (vertex.normal.z() < 0.0f ? 4 : 0);
    return {along(0), along(1), along(2), octant};
}

struct Cluster {
    Vec3f sum = Vec3f::Zero();
    std::vector<std::uint32_t> vertices;
};

}  // namespace

std::vector<Triangle> coarse_triangles(std::span<const Triangle> triangles,
                                       std::span<const view::LitVertex> rest, float cell) {
    std::map<Key, Cluster> clusters;
    for (std::uint32_t v = 0; v < rest.size(); ++v) {
        Cluster& cluster = clusters[key_of(rest[v], cell)];
        cluster.sum += rest[v].position;
        cluster.vertices.push_back(v);
    }
    std::vector<std::uint32_t> stands_for(rest.size());
    for (const auto& [key, cluster] : clusters) {
        const Vec3f middle = cluster.sum / static_cast<float>(cluster.vertices.size());
        const auto distance = [&](std::uint32_t v) { return (rest[v].position - middle).squaredNorm(); };
        std::uint32_t nearest = cluster.vertices.front();
        for (const std::uint32_t v : cluster.vertices) {
            nearest = distance(v) < distance(nearest) ? v : nearest;
        }
        for (const std::uint32_t v : cluster.vertices) {
            stands_for[v] = nearest;
        }
    }
    std::vector<Triangle> coarse;
    std::set<Triangle> known;
    for (const Triangle& t : triangles) {
        const Triangle moved{stands_for[t[0]], stands_for[t[1]], stands_for[t[2]]};
        if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0] &&
            known.insert(moved).second) {
            coarse.push_back(moved);
        }
    }
    return coarse;
}

}  // namespace eti::render
