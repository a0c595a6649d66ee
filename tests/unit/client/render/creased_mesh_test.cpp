// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/creased_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "common/model/tools/tools.hpp"

namespace eti {
namespace {

using Edge = std::pair<std::array<float, 3>, std::array<float, 3>>;

std::array<float, 3> place(const view::LitVertex& vertex) {
    return {vertex.position.x(), vertex.position.y(), vertex.position.z()};
}

// Number of triangles at each edge, by the positions of its ends: vertices are duplicated at creases.
std::map<Edge, int> edges_of(const render::CreasedMesh& mesh) {
    std::map<Edge, int> edges;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = place(mesh.vertices[t[k]]), b = place(mesh.vertices[t[(k + 1) % 3]]);
            ++edges[std::minmax(a, b)];
        }
    }
    return edges;
}

double area_of(const render::CreasedMesh& mesh) {
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3f& p = mesh.vertices[a].position;
        area += 0.5 * static_cast<double>(
                          (mesh.vertices[b].position - p).cross(mesh.vertices[c].position - p).norm());
    }
    return area;
}

TEST(CreasedMesh, EdgeSubdivisionKeepsSurfaceWatertight) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    const render::CreasedMesh coarse = render::creased(laryngoscope_mesh(scope), 0.7f);
    const auto longest = [&](const Vec3f& at) {
        return std::max(1e-3f, 0.25f * (at - Vec3f(0.0f, 0.0f, scope.blade_length)).norm());
    };
    const render::CreasedMesh fine = render::subdivide_long_edges(coarse, longest);
    EXPECT_GT(fine.triangles.size(), coarse.triangles.size());
    EXPECT_NEAR(area_of(fine) / area_of(coarse), 1.0, 1e-5);
    for (const auto& [edge, count] : edges_of(fine)) {
        const Vec3f a(edge.first.data()), b(edge.second.data());
        // Closed before, closed now: where two triangles disagreed, an edge would occur once.
        EXPECT_EQ(count % 2, 0) << a.transpose() << " to " << b.transpose();
        EXPECT_LE((a - b).norm(), longest(0.5f * (a + b)));
    }
    for (const view::LitVertex& vertex : fine.vertices) {
        EXPECT_NEAR(vertex.normal.norm(), 1.0f, 1e-5f);
    }
}

}  // namespace
}  // namespace eti
