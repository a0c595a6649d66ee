// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::rigid::test {

inline constexpr float blade_radius = 4e-3f;

/// A laryngoscope whose blade is one straight rod of 4 mm radius along z, so that contact with a plane has a
/// closed form; the handle stands off the blade.
inline Laryngoscope rod_scope() {
    Laryngoscope scope;
    scope.blade_length = 0.1f;
    scope.capsules = {Capsule{{0, 0.03f, 0}, {0, 0.12f, 0}, 0.012f},
                      Capsule{{0, 0, 0}, {0, 0, 0.05f}, blade_radius},
                      Capsule{{0, 0, 0.05f}, {0, 0, 0.1f - blade_radius}, blade_radius}};
    return scope;
}

/// Appends a rectangle `origin + i u + j v`, split into `nu` by `nv` cells, facing u x v.
inline void append_rectangle(TriangleMesh& mesh, const Vec3f& origin, const Vec3f& u, const Vec3f& v, int nu,
                             int nv) {
    const std::uint32_t first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int j = 0; j <= nv; ++j) {
        for (int i = 0; i <= nu; ++i) {
            mesh.vertices.push_back(origin + (static_cast<float>(i) / static_cast<float>(nu)) * u +
                                    (static_cast<float>(j) / static_cast<float>(nv)) * v);
        }
    }
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (nu + 1) + i); };
    for (int j = 0; j < nv; ++j) {
        for (int i = 0; i < nu; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
}

/// Merges coincident vertices, so that the topology is known across rectangles.
inline TriangleMesh welded(const TriangleMesh& mesh) {
    TriangleMesh out;
    std::map<std::array<long, 3>, std::uint32_t> index;
    std::vector<std::uint32_t> renamed;
    for (const Vec3f& p : mesh.vertices) {
        const std::array<long, 3> key = {std::lround(p.x() * 1e6f), std::lround(p.y() * 1e6f),
                                         std::lround(p.z() * 1e6f)};
        const auto [found, fresh] = index.try_emplace(key, static_cast<std::uint32_t>(out.vertices.size()));
        if (fresh) {
            out.vertices.push_back(p);
        }
        renamed.push_back(found->second);
    }
    for (const Triangle& t : mesh.triangles) {
        out.triangles.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]]});
    }
    return out;
}

/// A floor at y = 0 facing +y, `size` [m] wide, around the origin.
inline TriangleMesh floor_mesh(float size, int cells) {
    TriangleMesh mesh;
    append_rectangle(mesh, {-size / 2, 0, -size / 2}, {0, 0, size}, {size, 0, 0}, cells, cells);
    return mesh;
}

/// A closed box facing outwards.
inline TriangleMesh box_mesh(const Vec3f& low, const Vec3f& high, int cells) {
    TriangleMesh mesh;
    const Vec3f s = high - low;
    const Vec3f x(s.x(), 0, 0);
    const Vec3f y(0, s.y(), 0);
    const Vec3f z(0, 0, s.z());
    append_rectangle(mesh, low, y, x, cells, cells);
    append_rectangle(mesh, low, x, z, cells, cells);
    append_rectangle(mesh, low, z, y, cells, cells);
    append_rectangle(mesh, high, -x, -y, cells, cells);
    append_rectangle(mesh, high, -z, -x, cells, cells);
    append_rectangle(mesh, high, -y, -z, cells, cells);
    return welded(mesh);
}

inline std::vector<Tissue> tissue_of(const TriangleMesh& mesh, Tissue tissue = Tissue::soft) {
    return std::vector<Tissue>(mesh.triangles.size(), tissue);
}

}  // namespace eti::rigid::test
