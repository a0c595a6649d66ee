// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/app/run/patient_cache.hpp"
#include "server/scene/scene.hpp"
#include "server/scene/tissue.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"

namespace eti::scene {
namespace {

constexpr int epiglottis_substeps = 8;
constexpr float epiglottis_dt = step_duration / epiglottis_substeps;

/// Response of a newborn's tissue to dragging one particle of the epiglottis (Xiao et al. 2020, Fig. 5).
class EpiglottisTest : public ::testing::Test {
  protected:
    EpiglottisTest()
        : patient_(app::cached_patient(
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

    /// Displacements [m] of all particles when the dragged one is held `by` off its rest position for a
    /// second.
    std::vector<float> drag(const Vec3f& by) {
        patient::Patient held = patient_;
        held.particles.mass[dragged_] = 0.0f;
        SoftTissue tissue(held, TissueMethod::clusters, epiglottis_dt);
        pbd::SoftBody& body = tissue.body();
        body.particles.rest[dragged_] += by;  // massless particles move by their rest position
        for (int step = 0; step < steps_per_second; ++step) {
            for (int s = 0; s < epiglottis_substeps; ++s) {
                body.predict(epiglottis_dt, 1.0f / static_cast<float>(epiglottis_substeps - s));
                body.project(epiglottis_dt);
                body.finish(epiglottis_dt);
            }
        }
        std::vector<float> moved;
        for (std::size_t i = 0; i < patient_.particles.size(); ++i) {
            moved.push_back((body.particles.position[i] - patient_.particles.rest[i]).norm());
        }
        return moved;
    }

    /// Mean displacement [m] of the plate's other particles within 4 mm of the dragged one.
    [[nodiscard]] float mean_of_plate(const std::vector<float>& moved) const {
        const patient::ParticleSet& set = patient_.particles;
        float sum = 0.0f;
        float count = 0.0f;
        for (std::size_t i = 0; i < set.size(); ++i) {
            if (set.tissue[i] == Tissue::epiglottis && i != dragged_ &&
                (set.rest[i] - set.rest[dragged_]).norm() < 4e-3f) {
                sum += moved[i];
                count += 1.0f;
            }
        }
        EXPECT_GT(count, 5.0f);
        return sum / count;
    }

    /// The defect of the paper's figure: the plate's cluster also holds everything within 3 mm of it.
    void join_neighbours() {
        const patient::ParticleSet& set = patient_.particles;
        patient::ClusterSet joined = patient_.clusters;
        joined.first.assign(1, 0);
        joined.member.clear();
        for (std::size_t c = 0; c < patient_.clusters.size(); ++c) {
            const auto members = patient_.clusters.members(c);
            joined.member.insert(joined.member.end(), members.begin(), members.end());
            if (joined.tissue[c] == Tissue::epiglottis) {
                for (std::uint32_t i = 0; i < set.size(); ++i) {
                    if (set.tissue[i] != Tissue::epiglottis &&
                        std::ranges::any_of(members, [&](std::uint32_t k) {
                            return (set.rest[i] - set.rest[k]).norm() < 3e-3f;
                        })) {
                        joined.member.push_back(i);
                    }
                }
            }
            joined.first.push_back(static_cast<std::uint32_t>(joined.member.size()));
        }
        patient_.clusters = joined;
    }

    /// Links between the plate and the folds at its edges.
    [[nodiscard]] std::vector<std::uint32_t> links_of_folds() const {
        std::vector<std::uint32_t> folds;
        for (std::uint32_t l = 0; l < patient_.links.ends.size(); ++l) {
            const auto& [a, b] = patient_.links.ends[l];
            if (patient_.particles.tissue[a] == Tissue::epiglottis &&
                patient_.particles.tissue[b] == Tissue::larynx) {
                folds.push_back(l);
            }
        }
        return folds;
    }

    static constexpr float pull = 2e-3f;
    patient::Patient patient_;
    std::size_t dragged_ = 0;
};

TEST_F(EpiglottisTest, DraggedPlateBendsAndDistantTissueStays) {
    const std::vector<float> moved = drag({0.0f, pull, 0.0f});
    ASSERT_NEAR(moved[dragged_], pull, 1e-5f);
    EXPECT_GT(mean_of_plate(moved), 0.3f * pull) << "the plate goes along";
    const patient::ParticleSet& set = patient_.particles;
    float far = 0.0f;
    std::size_t far_count = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        // As far away as the plate is long.
        if ((set.rest[i] - set.rest[dragged_]).norm() > 15e-3f && set.mass[i] > 0.0f &&
            set.tissue[i] != Tissue::epiglottis) {
            far = std::max(far, moved[i]);
            ++far_count;
        }
    }
    ASSERT_GT(far_count, 100u);
    EXPECT_LT(far, 0.05f * pull) << "far tissue moves by less than 5 %";
}

TEST_F(EpiglottisTest, SharedClusterWithTongueRestrainsPlate) {
    const float free = mean_of_plate(drag({0.0f, pull, 0.0f}));
    join_neighbours();
    EXPECT_LT(mean_of_plate(drag({0.0f, pull, 0.0f})), 0.5f * free);
}

TEST_F(EpiglottisTest, FoldsFollowPlateSymmetrically) {
    const std::vector<std::uint32_t> folds = links_of_folds();
    ASSERT_GT(folds.size(), 20u);
    Vec3f sides = Vec3f::Zero();
    for (const std::uint32_t l : folds) {
        const auto [plate, fold] = patient_.links.ends[l];
        sides += patient_.particles.rest[plate];
        // E A / l of a particle; tissue of the larynx has 32 kPa.
        EXPECT_FLOAT_EQ(patient_.links.stiffness[l], 32e3f * 1.25e-3f);
    }
    EXPECT_NEAR(sides.x() / static_cast<float>(folds.size()), 0.0f, 1e-6f);

    // Lifted, the plate pulls the folds along. With the links cut, they stay: the rest is transmitted by its
    // root.
    const auto mean_of_folds = [&] {
        const std::vector<float> moved = drag({0.0f, -pull, 0.0f});
        float sum = 0.0f;
        for (const std::uint32_t l : folds) {
            sum += moved[patient_.links.ends[l][1]];
        }
        return sum / static_cast<float>(folds.size());
    };
    const float held = mean_of_folds();
    std::vector<float>& stiffness = patient_.links.stiffness;
    std::ranges::for_each(folds, [&](std::uint32_t l) { stiffness[l] = 1e-6f; });
    const float cut = mean_of_folds();
    RecordProperty("held_um", static_cast<int>(1e6f * held));
    RecordProperty("cut_um", static_cast<int>(1e6f * cut));
    EXPECT_GT(held, 2.0f * cut);
}

// The plate under trial, whose links are part of the solve. When they also pulled at the larynx, it left its
// rest by itself.
TEST(EpiglottisPlateScene, ReturnsToRestAfterTilt) {
    patient::BuildSettings settings = test::coarse_build;
    settings.plate = true;
    const patient::Patient patient = app::cached_patient({}, settings);
    Inputs inputs = test::parked_tools(20.0f, 25.0f);
    Scene scene(patient, make_laryngoscope(Blade::miller_1), Tube{}, inputs, {});
    const pbd::Particles& p = scene.tissue().body().particles;
    std::vector<std::uint32_t> plate;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        if (patient.particles.tissue[i] == Tissue::epiglottis) {
            plate.push_back(i);
            ASSERT_TRUE(scene.tissue().tongue().moves(i)) << i;
        }
    }
    ASSERT_GT(plate.size(), 60u);
    const auto farthest = [&] {
        float most = 0.0f;
        for (const std::uint32_t i : plate) {
            most = std::max(most, (p.position[i] - p.rest[i]).norm());
        }
        return most;
    };
    inputs.runtime_parameters.table_angle = 0.3f;
    test::hold(scene, inputs, 2 * steps_per_second);
    EXPECT_GT(farthest(), 20e-6f) << "it sags";
    inputs.runtime_parameters.table_angle = 0.0f;
    test::hold(scene, inputs, 5 * steps_per_second);
    EXPECT_LT(farthest(), 20e-6f);
}

}  // namespace
}  // namespace eti::scene
