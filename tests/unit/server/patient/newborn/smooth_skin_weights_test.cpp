// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/patient/newborn/build/build.hpp"
#include "tests/support/shipped_newborn.hpp"

namespace eti::patient {
namespace {

constexpr float shortest_levelled_edge = 2e-4f;  // [m], as in build_skin_test.cpp

// The plate moves 10 mm forward, as in the expert's best view of a term newborn; the surrounding tissue 4 mm,
// decreasing with the distance from the valleculae; tissue held by bones stays.
std::vector<FramePose> lifted(const Patient& patient) {
    const Vec3f vallecula = patient.landmarks[static_cast<std::size_t>(Landmark::vallecula)].rest;
    const Vec3f root = patient.landmarks[static_cast<std::size_t>(Landmark::epiglottis_base)].rest;
    const Vec3f plate_way = patient.landmarks[static_cast<std::size_t>(Landmark::epiglottis_tip)].rest - root;
    std::vector<FramePose> frames;
    for (std::size_t f = 0; f < patient.frame_rest_centre.size(); ++f) {
        const Vec3f& centre = patient.frame_rest_centre[f];
        frames.push_back({centre, Quatf::Identity()});
        if (f < bone_count || f >= bone_count + patient.clusters.size()) {
            continue;
        }
        const float off = (centre - vallecula).norm() / 15e-3f;
        const bool plate = patient.clusters.tissue[f - bone_count] == Tissue::epiglottis;
        const float up = std::clamp((centre - root).dot(plate_way) / plate_way.squaredNorm(), 0.0f, 1.0f);
        frames.back().centre.y() -= plate ? 4e-3f + 6e-3f * up : 4e-3f * std::exp(-off * off);
    }
    return frames;
}

TEST(LevelSkin, LiftDoesNotTearSkin) {
    const Patient& patient = test::shipped_newborn();
    const std::vector<FramePose> frames = lifted(patient);
    for (const Surface& surface : patient.surfaces) {
        if (surface.tissue != Tissue::soft && surface.tissue != Tissue::tongue) {
            continue;
        }
        std::vector<Vec3f> now;
        for (std::size_t v = 0; v < surface.skin.size(); ++v) {
            now.push_back(
                skin_point(surface.mesh.vertices[v], surface.skin[v], patient.frame_rest_centre, frames));
        }
        float most = 0.0f;
        std::size_t torn = 0;
        Vec3f where = Vec3f::Zero();
        for (const Triangle& t : surface.mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                const float length = (surface.mesh.vertices[a] - surface.mesh.vertices[b]).norm();
                const float ratio =
                    length < shortest_levelled_edge ? 0.0f : (now[a] - now[b]).norm() / length;
                torn += ratio > 3.0f ? 1 : 0;
                if (ratio > most) {
                    most = ratio;
                    where = surface.mesh.vertices[a];
                }
            }
        }
        // The goal is three. With weights by position alone some edges stretched 19 times.
        EXPECT_LE(most, 6.0f) << surface.name << " at " << 1e3f * where.transpose() << " mm";
        EXPECT_LE(torn, surface.mesh.triangles.size() / 100) << surface.name;
    }
}

}  // namespace
}  // namespace eti::patient
