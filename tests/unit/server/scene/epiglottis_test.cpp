// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>

#include "server/anatomy/build.hpp"
#include "server/scene/scene.hpp"
#include "server/scene/tissue.hpp"

namespace eti::scene {
namespace {

constexpr int substeps = 8;
constexpr float dt = step_duration / substeps;

/// How the tissue of a newborn follows one particle of the epiglottis that is drawn aside (Xiao et al. 2020,
/// Fig. 5).
class EpiglottisTest : public ::testing::TestWithParam<TissueModel> {
  protected:
    EpiglottisTest()
        : patient_(anatomy::build_patient(
              NewbornShape(), {.spacing = 2.5e-3f, .fine_spacing = 1.25e-3f, .surface_spacing = 2.5e-3f})) {
        const Vec3f tip = patient_.landmarks[static_cast<std::size_t>(Landmark::epiglottis_tip)].rest;
        float nearest = 1.0f;
        for (std::size_t i = 0; i < patient_.particles.size(); ++i) {
            const float away = (patient_.particles.rest[i] - tip).norm();
            if (patient_.particles.tissue[i] == Tissue::epiglottis && away < nearest) {
                nearest = away;
                dragged_ = i;
            }
        }
    }

    /// Displacements [m] of all particles when the dragged one is held `by` off its rest for a second.
    std::vector<float> drag(const Vec3f& by) {
        anatomy::Patient held = patient_;
        held.particles.mass[dragged_] = 0.0f;
        SoftTissue tissue(held, GetParam(), dt);
        pbd::SoftBody& body = tissue.body();
        body.particles.rest[dragged_] += by;  // where what has no mass goes
        for (int step = 0; step < steps_per_second; ++step) {
            for (int s = 0; s < substeps; ++s) {
                body.predict(dt, 1.0f / static_cast<float>(substeps - s));
                body.project(dt);
                body.finish(dt);
            }
        }
        std::vector<float> moved;
        for (std::size_t i = 0; i < patient_.particles.size(); ++i) {
            moved.push_back((body.particles.position[i] - patient_.particles.rest[i]).norm());
        }
        return moved;
    }

    anatomy::Patient patient_;
    std::size_t dragged_ = 0;
};

TEST_P(EpiglottisTest, DraggedItBendsAndFarTissueStays) {
    constexpr float pull = 2e-3f;
    const std::vector<float> moved = drag({0.0f, pull, 0.0f});
    ASSERT_NEAR(moved[dragged_], pull, 1e-5f);
    const anatomy::ParticleSet& set = patient_.particles;
    const Vec3f from = set.rest[dragged_];
    float plate = 0.0f;
    float near_count = 0.0f;
    float far = 0.0f;
    std::size_t far_count = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        const float away = (set.rest[i] - from).norm();
        if (set.tissue[i] == Tissue::epiglottis && away < 4e-3f && i != dragged_) {
            plate += moved[i];
            near_count += 1.0f;
        }
        // Twice the plate's length away nothing of it should be felt.
        if (away > 30e-3f && set.mass[i] > 0.0f) {
            far = std::max(far, moved[i]);
            ++far_count;
        }
    }
    ASSERT_GT(near_count, 5.0f);
    ASSERT_GT(far_count, 100u);
    EXPECT_GT(plate / near_count, 0.3f * pull) << "the plate goes along";
    EXPECT_LT(far, 0.05f * pull) << "far tissue moves by less than 5 %";
}

INSTANTIATE_TEST_SUITE_P(TissueModels, EpiglottisTest,
                         ::testing::Values(TissueModel::clusters, TissueModel::tetrahedra),
                         [](const auto& test) {
                             return test.param == TissueModel::clusters ? "clusters" : "tetrahedra";
                         });

}  // namespace
}  // namespace eti::scene
