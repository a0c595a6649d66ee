// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/creased_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace eti::render {

CreasedMesh creased(const TriangleMesh& mesh, float angle) {
    std::vector<Vec3f> doubled_area(mesh.triangles.size());
    std::vector<std::vector<std::uint32_t>> around(mesh.vertices.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        doubled_area[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        for (const std::uint32_t v : mesh.triangles[t]) {
            around[v].push_back(t);
        }
    }
    const float least_cosine = std::cos(angle);
    const auto smooth = [&](std::uint32_t s, std::uint32_t t, std::uint32_t v) {
        // Neighbours at `v` share another corner.
        const bool neighbours = std::ranges::any_of(mesh.triangles[s], [&](std::uint32_t w) {
            return w != v && std::ranges::find(mesh.triangles[t], w) != mesh.triangles[t].end();
        });
        return neighbours && doubled_area[s].normalized().dot(doubled_area[t].normalized()) > least_cosine;
    };
    CreasedMesh result;
    result.vertices.resize(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        result.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        std::vector<std::uint32_t> left = around[v];
        while (!left.empty()) {
            // All faces connected by smooth edges share one normal here, or a triangle would stand out.
            std::vector<std::uint32_t> group{left.back()};
            left.pop_back();
            for (std::size_t i = 0; i < group.size(); ++i) {
                const std::uint32_t member = group[i];
                std::erase_if(left, [&](std::uint32_t other) {
                    if (smooth(member, other, v)) {
                        group.push_back(other);
                        return true;
                    }
                    return false;
                });
            }
            Vec3f normal = Vec3f::Zero();
            for (const std::uint32_t t : group) {
                normal += doubled_area[t];
            }
            const float length = normal.norm();
            normal = length > 1e-20f ? Vec3f(normal / length) : Vec3f::UnitZ();
            for (const std::uint32_t t : group) {
                const auto corner = std::ranges::find(mesh.triangles[t], v) - mesh.triangles[t].begin();
                result.vertices[3 * t + static_cast<std::size_t>(corner)] = {mesh.vertices[v], normal};
            }
        }
    }
    return result;
}

CreasedMesh subdivide_long_edges(CreasedMesh mesh, const std::function<float(const Vec3f&)>& longest) {
    for (bool changed = true; changed;) {
        changed = false;
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto halved = [&](std::uint32_t a, std::uint32_t b) {
            const view::LitVertex &p = mesh.vertices[a], &q = mesh.vertices[b];
            // The sum is commutative, so that copies of an edge get the same midpoint.
            const Vec3f middle = 0.5f * (p.position + q.position);
            return (p.position - q.position).norm() > longest(middle);
        };
        const auto middle_of = [&](std::uint32_t a, std::uint32_t b) {
            const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
            const auto [known, made] = middles.try_emplace(std::minmax(a, b), next);
            if (made) {
                const view::LitVertex p = mesh.vertices[a], q = mesh.vertices[b];
                mesh.vertices.push_back(
                    {0.5f * (p.position + q.position), (p.normal + q.normal).normalized()});
            }
            return known->second;
        };
        std::vector<Triangle> finer;
        for (const Triangle& t : mesh.triangles) {
            std::array<bool, 3> cut{};  // edge k from corner k to the next
            for (std::size_t k = 0; k < 3; ++k) {
                cut[k] = halved(t[k], t[(k + 1) % 3]);
            }
            const auto count = std::ranges::count(cut, true);
            if (count == 0) {
                finer.push_back(t);
                continue;
            }
            changed = true;
            // Rotated so that the first edge is split, and of two the next one, too.
            std::size_t first = 0;
            while (!cut[first] || (count == 2 && !cut[(first + 1) % 3])) {
                ++first;
            }
            const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
            const std::uint32_t ab = middle_of(a, b);
            if (count == 1) {
                finer.insert(finer.end(), {{a, ab, c}, {ab, b, c}});
                continue;
            }
            const std::uint32_t bc = middle_of(b, c);
            finer.push_back({ab, b, bc});
            if (count == 2) {
                finer.insert(finer.end(), {{a, ab, bc}, {a, bc, c}});
            } else {
                const std::uint32_t ca = middle_of(c, a);
                finer.insert(finer.end(), {{a, ab, ca}, {ab, bc, ca}, {ca, bc, c}});
            }
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

}  // namespace eti::render
