// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/skin_frame_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/app/run/patient_cache.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "server/scene/tissue.hpp"

namespace eti::scene {
namespace {

/// One tetrahedron and three vertices within it, skinned to a cluster and in part to a bone.
patient::Patient small() {
    patient::Patient patient;
    patient.particles.rest = {Vec3f::Zero(), Vec3f::UnitX(), Vec3f::UnitY(), Vec3f::UnitZ()};
    patient.tetrahedra.corners = {{0, 1, 2, 3}};
    patient.clusters.first = {0, 4};
    patient.clusters.member = {0, 1, 2, 3};
    patient.clusters.tissue = {Tissue::tongue};
    patient.frame_rest_centre.assign(patient::bone_count + 1, Vec3f::Constant(0.25f));
    Surface& surface = patient.surfaces.emplace_back();
    surface.tissue = Tissue::tongue;
    for (const Vec3f& at : {Vec3f(0.1f, 0.1f, 0.1f), Vec3f(0.2f, 0.1f, 0.1f), Vec3f(0.1f, 0.2f, 0.1f)}) {
        surface.mesh.vertices.push_back(at);
        surface.skin.push_back({{static_cast<std::uint16_t>(patient::bone_count), 0}, {0.75f, 0.25f}});
    }
    return patient;
}

/// All its frames, unrotated.
std::vector<FramePose> frames_at(const Vec3f& centre) {
    FramePose pose;
    pose.centre = centre;
    return std::vector<FramePose>(patient::bone_count + 1, pose);
}

TEST(SkinFrameCorrection, FrameShiftsByVertexError) {
    const patient::Patient patient = small();
    SkinFrameCorrection fit;
    fit.configure(patient, std::array{0u});
    ASSERT_EQ(fit.size(), 1u);
    const Vec3f by(0.01f, -0.02f, 0.03f);
    std::vector<Vec3f> position = patient.particles.rest;
    for (Vec3f& x : position) {
        x += by;
    }
    std::vector<FramePose> frames = frames_at(Vec3f::Constant(0.25f));
    fit.shift(position, frames);
    EXPECT_EQ(frames[0].centre, Vec3f::Constant(0.25f));  // a bone stays
    // Each round leaves a quarter of the error, the bone's share.
    const Vec3f drawn = 0.75f * (frames[patient::bone_count].centre - Vec3f::Constant(0.25f));
    EXPECT_LT((drawn - (1.0f - std::pow(0.25f, 3.0f)) * by).norm(), 1e-6f);
}

TEST(SkinFrameCorrection, MatchingMeshNeedsNoShift) {
    const patient::Patient patient = small();
    SkinFrameCorrection fit;
    fit.configure(patient, std::array{0u});
    std::vector<FramePose> frames = frames_at(Vec3f::Constant(0.25f));
    fit.shift(patient.particles.rest, frames);
    EXPECT_LT((frames[patient::bone_count].centre - Vec3f::Constant(0.25f)).norm(), 1e-6f);
}

TEST(SkinFrameCorrection, FramesWithoutTetrahedraStay) {
    const patient::Patient patient = small();
    SkinFrameCorrection fit;
    fit.configure(patient, {});
    EXPECT_EQ(fit.size(), 0u);
    std::vector<FramePose> frames = frames_at(Vec3f::Ones());
    fit.shift(patient.particles.rest, frames);
    EXPECT_EQ(frames[patient::bone_count].centre, Vec3f::Ones());
}

/// A dent in a newborn's tongue, with a known displacement at every point.
TEST(SkinFrameCorrection, DentIsDrawnAtItsPosition) {
    const patient::Patient patient = app::cached_patient(
        NewbornShape(), {.spacing = 2.5e-3f, .fine_spacing = 1.25e-3f, .surface_spacing = 2.5e-3f});
    const auto tongue = std::ranges::find(patient.surfaces, Tissue::tongue, &Surface::tissue);
    ASSERT_NE(tongue, patient.surfaces.end());
    const auto highest = std::ranges::max_element(tongue->mesh.vertices, {}, [](const Vec3f& v) {
        return v.z();  // up is to the crown
    });
    const auto way = [&](const Vec3f& rest) -> Vec3f {
        return -4e-3f * std::exp(-(rest - *highest).squaredNorm() / (2.0f * 4e-3f * 4e-3f)) * Vec3f::UnitZ();
    };
    SoftTissue tissue(patient, TissueMethod::implicit, 1.0f / 1440.0f);
    std::vector<FramePose> frames;
    tissue.frames(frames);
    const auto error = [&] {  // [m], RMS within the dent
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t v = 0; v < tongue->skin.size(); ++v) {
            const Vec3f& rest = tongue->mesh.vertices[v];
            if (way(rest).norm() > 1e-3f) {
                const Vec3f drawn = skin_point(rest, tongue->skin[v], patient.frame_rest_centre, frames);
                sum += static_cast<double>((drawn - rest - way(rest)).squaredNorm());
                count += 1.0;
            }
        }
        EXPECT_GT(count, 50.0);
        return std::sqrt(sum / count);
    };
    const double flat = error();
    std::vector<Vec3f>& position = tissue.body().particles.position;
    for (std::size_t i = 0; i < position.size(); ++i) {
        position[i] += way(patient.particles.rest[i]);
    }
    tissue.frames(frames);
    RecordProperty("flat_um", static_cast<int>(1e6 * flat));
    RecordProperty("drawn_um", static_cast<int>(1e6 * error()));
    EXPECT_GT(flat, 1.5e-3);
    // Linear interpolation from corner to corner would be off by h^2 / 8 times the curvature: for 2.5 mm by
    // 0.2 mm.
    EXPECT_LT(error(), 2.0 * 2.5e-3 * 2.5e-3 / 8.0 * 4e-3 / (4e-3 * 4e-3));

    // The query vertices are spread over the tongue.
    SkinFrameCorrection fit;
    fit.configure(patient, patient::tetrahedra_of(Tissue::tongue, patient));
    EXPECT_GT(fit.size(), tongue->skin.size() / 5);
}

}  // namespace
}  // namespace eti::scene
