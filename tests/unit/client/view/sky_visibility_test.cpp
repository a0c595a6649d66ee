// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/sky_visibility.hpp"

#include <gtest/gtest.h>

#include "synthetic_scene.hpp"

namespace eti {
namespace {

TEST(SkyVisibility, IsHighOutsideAndLowInThroat) {
    const TriangleMesh body = synthetic::body_mesh();
    const std::vector<float> sky = view::sky_visibility(body);
    ASSERT_EQ(sky.size(), body.vertices.size());
    int outside = 0, throat = 0;
    float open = 0.0f;
    for (std::size_t v = 0; v < sky.size(); ++v) {
        const Vec3f& p = body.vertices[v];
        if (p.z() > 0.06f) {
            // The crown is convex: nothing occludes it. Slivers from marching tetrahedra tilt a vertex's
            // normal by up to 50 deg, so that single vertices sample below the horizon.
            EXPECT_GT(sky[v], 0.5f);
            open += sky[v];
            ++outside;
        }
        if (std::hypot(p.x(), p.y() - 0.044f) < 0.006f && p.z() < -0.05f && p.z() > -0.095f) {
            // The trachea, 5 cm beyond the mouth's bend.
            EXPECT_LT(sky[v], 0.05f);
            ++throat;
        }
    }
    EXPECT_GT(outside, 100);
    EXPECT_GT(open / static_cast<float>(outside), 0.98f);
    EXPECT_GT(throat, 50);
}

}  // namespace
}  // namespace eti
