// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/laryngoscope_details.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "client/render/lighting.hpp"
#include "common/mesh/closest_point.hpp"

namespace eti::render {
namespace {

float capsule_distance(const Capsule& capsule, const Vec3f& p) {
    return offset_from_segment(capsule.a, capsule.b, p).norm() - capsule.radius;
}

// Distance [m] to a surface; 0 within it.
float distance_outside(const TriangleMesh& mesh, const Vec3f& p) {
    float nearest = std::numeric_limits<float>::max();
    bool within = false;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3f &u = mesh.vertices[a], &v = mesh.vertices[b], &w = mesh.vertices[c];
        const Vec3f apart = p - closest_on_triangle(p, u, v, w).point;
        if (apart.norm() < nearest) {
            nearest = apart.norm();
            within = apart.dot((v - u).cross(w - u)) < 0.0f;
        }
    }
    return within ? 0.0f : nearest;
}

class LaryngoscopeParts : public testing::TestWithParam<Blade> {
  protected:
    Laryngoscope scope_ = make_laryngoscope(GetParam());
    Solid details_ = laryngoscope_details(scope_);
    TriangleMesh blade_ = laryngoscope_mesh(scope_);
};

// Tissue touches the blade from the heel to the tip, and at most the side of the handle.
TEST_P(LaryngoscopeParts, KeepToTheContactShape) {
    int before_heel = 0, outside = 0;
    for (const view::LitVertex& vertex : details_.vertices) {
        const Vec3f& p = vertex.position;
        float nearest = std::numeric_limits<float>::max();
        for (const Capsule& capsule : scope_.capsules) {
            nearest = std::min(nearest, capsule_distance(capsule, p));
        }
        const bool on_blade = p.z() > 12e-3f;
        if (on_blade) {
            nearest = std::min(nearest, distance_outside(blade_, p));
        } else if (p.y() > scope_.capsules[0].b.y()) {
            continue;  // the cap, out of any patient's reach
        }
        before_heel += on_blade ? 0 : 1;
        outside += nearest > 0.0f ? 1 : 0;
        EXPECT_LE(nearest, laryngoscope_detail_protrusion + 1e-6f) << "at " << p.transpose();
    }
    EXPECT_GT(before_heel, 100);
    EXPECT_GT(outside, 100) << "details within the blade would not be seen";
}

TEST_P(LaryngoscopeParts, ChannelAheadOfTheLensIsFree) {
    // The lens looks along the channel, 1 mm before the bulb; the flange is on its left.
    constexpr float flange = 1.8e-3f;
    const float lens = scope_.blade_length - 15e-3f;
    for (const view::LitVertex& vertex : details_.vertices) {
        const Vec3f& p = vertex.position;
        EXPECT_FALSE(p.z() > lens && p.y() < 0.0f && p.x() < flange) << "at " << p.transpose();
    }
}

TEST_P(LaryngoscopeParts, GripIsKnurledAndCapIsPolished) {
    bool knurled = false;
    for (std::size_t v = 0; v < details_.vertices.size(); ++v) {
        const bool rough = details_.colours[v][3] == knurled_gloss;
        knurled = knurled || rough;
        EXPECT_FALSE(rough && details_.vertices[v].position.y() > scope_.capsules[0].b.y());
        EXPECT_FALSE(rough && details_.vertices[v].position.y() < 30e-3f) << "on the blade";
    }
    EXPECT_TRUE(knurled);
}

TEST_P(LaryngoscopeParts, LightsTubeReachesTheBulb) {
    const Vec3f bulb = bulb_centre(scope_.blade_length);
    float nearest = 1.0f;
    for (const view::LitVertex& vertex : details_.vertices) {
        nearest = std::min(nearest, (vertex.position - bulb).norm());
    }
    EXPECT_LT(nearest, 1.7e-3f) << "a glass of 0.9 mm radius and 3.4 mm length";
}

INSTANTIATE_TEST_SUITE_P(Blades, LaryngoscopeParts, testing::Values(Blade::miller_0, Blade::miller_1),
                         [](const auto& blade) {
                             return blade.param == Blade::miller_0 ? "Miller0" : "Miller1";
                         });

}  // namespace
}  // namespace eti::render
