// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/normals.hpp"

namespace eti {

std::vector<Vec3f> vertex_normals(const TriangleMesh& mesh) {
    std::vector<Vec3f> normals(mesh.vertices.size(), Vec3f::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Vec3f& a = mesh.vertices[t[0]];
        const Vec3f twice_area = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
        for (const std::uint32_t v : t) {
            normals[v] += twice_area;
        }
    }
    for (Vec3f& normal : normals) {
        const float length = normal.norm();
        normal = length > 0.0f ? Vec3f(normal / length) : Vec3f(Vec3f::UnitZ());
    }
    return normals;
}

}  // namespace eti
