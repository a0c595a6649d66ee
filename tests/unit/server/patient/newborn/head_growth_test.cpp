// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/patient/newborn/newborn.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::patient {
namespace {

struct Off {
    double mean = 0.0;  // [mm], over the area
    double most = 0.0;  // [mm]
};

/// A third of the area of the triangles about each vertex [m^2].
std::vector<double> vertex_areas(const TriangleMesh& mesh) {
    std::vector<double> areas(mesh.vertices.size(), 0.0);
    for (const Triangle& t : mesh.triangles) {
        const Vec3f& a = mesh.vertices[t[0]];
        const double twice = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
        for (const std::uint32_t v : t) {
            areas[v] += twice / 6.0;
        }
    }
    return areas;
}

/// Distance of the grown cranium's skin and vault from those of a newborn built at that size.
Off off_built(const NewbornShape& shape, const Patient& patient, float wanted) {
    NewbornShape large = shape;
    large.head_scale = wanted;
    const Newborn built(large);
    std::vector<FramePose> frames;
    for (const Vec3f& centre : patient.frame_rest_centre) {
        frames.push_back({centre, Quatf::Identity()});
    }
    for (std::size_t f = frames.size() - head_frame_count; f < frames.size(); ++f) {
        frames[f].centre *= wanted / shape.head_scale;
    }
    Off off;
    double area = 0.0;
    int count = 0;
    for (const Surface& surface : patient.surfaces) {
        const std::vector<double> areas = vertex_areas(surface.mesh);
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            const Vec3f& rest = surface.mesh.vertices[i];
            if (surface.tissue != Tissue::soft || built.to_model(rest).z() < 26.0f) {
                continue;  // the field gives the nearer one of the skull's two sides
            }
            const Vec3f place = skin_point(rest, surface.skin[i], patient.frame_rest_centre, frames);
            const double here = 1e3 * std::fabs(static_cast<double>(built.visible_fields(place).body));
            off.mean += areas[i] * here;
            off.most = std::max(off.most, here);
            area += areas[i];
            ++count;
        }
    }
    off.mean /= area;
    EXPECT_GT(count, 500);
    return off;
}

TEST(HeadGrowth, MatchesNewbornBuiltAtThatSize) {
    NewbornShape premature;
    premature.weight = 0.8f;
    premature.gestational_age = 26.0f;
    premature.head_scale = 0.9f;
    for (const NewbornShape& shape : {NewbornShape(), premature}) {
        const Patient patient =
            shape.weight < 1.0f ? build_patient(shape, test::coarse_build) : test::coarse_newborn();
        const Off untouched = off_built(shape, patient, shape.head_scale);
        for (const float wanted : {0.85f, 0.95f, 1.05f, 1.15f}) {
            const Off off = off_built(shape, patient, wanted);
            EXPECT_LT(off.mean, 0.2) << wanted;
            // Ears, which stand off the head, grow with its widest part.
            EXPECT_LT(off.most, untouched.most + 1.5) << wanted;
        }
    }
}

TEST(HeadGrowth, MovesOnlySkullBoundVertices) {
    const Patient& patient = test::coarse_newborn();
    const std::size_t first = bone_count + patient.clusters.size();
    std::size_t grow = 0;
    for (const Surface& surface : patient.surfaces) {
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            const SkinWeights& skin = surface.skin[i];
            if (std::ranges::none_of(skin.frame, [&](std::uint16_t f) { return f >= first; })) {
                continue;
            }
            ++grow;
            EXPECT_TRUE(surface.tissue == Tissue::soft || surface.tissue == Tissue::skull) << surface.name;
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                EXPECT_GE(skin.weight[k], 0.0f);
                EXPECT_TRUE(skin.weight[k] == 0.0f || skin.frame[k] >= first ||
                            skin.frame[k] == static_cast<std::uint16_t>(Bone::skull));
            }
        }
    }
    EXPECT_GT(grow, 1000u);
}

}  // namespace
}  // namespace eti::patient
