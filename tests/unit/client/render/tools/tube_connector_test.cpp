// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/tube_connector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "common/mesh/check.hpp"

namespace eti::render {
namespace {

// Joins vertices that are duplicated along edges.
TriangleMesh welded(const TubeConnector& connector) {
    std::map<std::array<int, 3>, std::uint32_t> known;
    TriangleMesh mesh;
    std::vector<std::uint32_t> joined;
    for (const view::TubeVertex& vertex : connector.vertices) {
        const Eigen::Vector3i micrometres = (1e6f * vertex.position).array().round().cast<int>();
        const auto [place, made] = known.try_emplace({micrometres.x(), micrometres.y(), micrometres.z()},
                                                     static_cast<std::uint32_t>(mesh.vertices.size()));
        if (made) {
            mesh.vertices.push_back(vertex.position);
        }
        joined.push_back(place->second);
    }
    for (const Triangle& t : connector.triangles) {
        mesh.triangles.push_back({joined[t[0]], joined[t[1]], joined[t[2]]});
    }
    return mesh;
}

TEST(TubeConnector, IsClosedAndHollow) {
    for (const float inner : {2.0e-3f, 3.0e-3f, 4.5e-3f}) {
        Tube tube;
        tube.inner_diameter = inner;
        tube.outer_diameter = outer_diameter_of(inner);
        const MeshReport report = check(welded(make_tube_connector(tube)));
        EXPECT_TRUE(report.is_valid()) << report.describe();
        EXPECT_EQ(report.euler_characteristic, 0) << "open at both ends";
        EXPECT_GT(report.volume, 0.0);
    }
}

// ISO 5356-1: a 15 mm cone, tapering by 1 in 40.
TEST(TubeConnector, ConeHasStandardSize) {
    const TubeConnector connector = make_tube_connector({});
    const auto radius_at = [&](float z) {  // [m], of the outer wall
        float radius = 0.0f;
        for (const view::TubeVertex& vertex : connector.vertices) {
            if (std::abs(vertex.position.z() - z) < 1e-5f) {
                radius = std::max(radius, vertex.position.head<2>().norm());
            }
        }
        return radius;
    };
    const float narrow = radius_at(-27.6e-3f), wide = radius_at(-9.6e-3f);
    EXPECT_NEAR(wide + narrow, 15.4e-3f, 0.2e-3f);
    EXPECT_NEAR(2.0f * (wide - narrow) / 18e-3f, 1.0f / 20.0f, 0.01f) << "of the diameter";
}

TEST(TubeConnector, LiesBeyondTheTubesLength) {
    const Tube tube;
    for (const view::TubeVertex& vertex : make_tube_connector(tube).vertices) {
        EXPECT_GT(vertex.from_tip, tube.length + 0.3e-3f);
        EXPECT_NEAR(vertex.normal.norm(), 1.0f, 1e-5f);
    }
}

}  // namespace
}  // namespace eti::render
