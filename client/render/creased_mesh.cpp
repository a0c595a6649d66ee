// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/creased_mesh.hpp"

#include <algorithm>
#include <cmath>

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
        // Neighbours about `v` share another corner.
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
            // All faces that go over into each other have one normal here, or a triangle would stand out.
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

}  // namespace eti::render
