// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/creased_mesh.hpp"

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
    CreasedMesh result;
    result.vertices.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3f face = doubled_area[t].normalized();
        const auto first = static_cast<std::uint32_t>(result.vertices.size());
        for (const std::uint32_t v : mesh.triangles[t]) {
            Vec3f normal = doubled_area[t];
            for (const std::uint32_t other : around[v]) {
                if (other != t && doubled_area[other].normalized().dot(face) > least_cosine) {
                    normal += doubled_area[other];
                }
            }
            const float length = normal.norm();
            result.vertices.push_back(
                {mesh.vertices[v], length > 1e-20f ? Vec3f(normal / length) : Vec3f::UnitZ()});
        }
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

}  // namespace eti::render
