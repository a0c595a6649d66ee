// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/patient_cache.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/support/coarse_newborn.hpp"

namespace eti::app {
namespace {

using test::coarse_build;

/// A cache of its own for each test.
class PatientCache : public ::testing::Test {
  protected:
    PatientCache() {
        folder_ = std::filesystem::temp_directory_path() / ("eti_cache_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        ::setenv("ETI_CACHE", folder_.c_str(), 1);
    }
    ~PatientCache() override {
        ::unsetenv("ETI_CACHE");
        std::filesystem::remove_all(folder_);
    }
    [[nodiscard]] std::ptrdiff_t files() const {
        return std::distance(std::filesystem::directory_iterator(folder_), {});
    }
    std::filesystem::path folder_;
};

void expect_same_surfaces(const anatomy::Patient& a, const anatomy::Patient& b) {
    ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
    for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
        EXPECT_EQ(a.surfaces[s].mesh.vertices, b.surfaces[s].mesh.vertices) << a.surfaces[s].name;
        EXPECT_EQ(a.surfaces[s].mesh.triangles, b.surfaces[s].mesh.triangles) << a.surfaces[s].name;
        EXPECT_EQ(a.surfaces[s].triangle_tissue, b.surfaces[s].triangle_tissue) << a.surfaces[s].name;
        ASSERT_EQ(a.surfaces[s].skin.size(), b.surfaces[s].skin.size());
        for (std::size_t v = 0; v < a.surfaces[s].skin.size(); ++v) {
            ASSERT_EQ(a.surfaces[s].skin[v].frame, b.surfaces[s].skin[v].frame) << a.surfaces[s].name;
            ASSERT_EQ(a.surfaces[s].skin[v].weight, b.surfaces[s].skin[v].weight) << a.surfaces[s].name;
        }
    }
    EXPECT_EQ(a.shell.mesh.vertices, b.shell.mesh.vertices);
    EXPECT_EQ(a.shell.distance.value, b.shell.distance.value);
}

TEST_F(PatientCache, AnotherStiffnessBuildsNothing) {
    anatomy::BuildSettings settings = coarse_build;
    const anatomy::Patient usual = cached_patient({}, settings);
    EXPECT_EQ(files(), 1);
    settings.tissue_stiffness = 12e3f;
    const anatomy::Patient stiff = cached_patient({}, settings);
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(stiff.tissue_stiffness, 12e3f);
    EXPECT_EQ(std::ranges::max(stiff.links.stiffness), 1.5f * std::ranges::max(usual.links.stiffness));
    expect_same_surfaces(stiff, usual);
}

// Reference: the same built from nothing.
TEST_F(PatientCache, OtherSpacingsBorrowTheSurfaces) {
    const anatomy::Patient usual = cached_patient({}, coarse_build);
    anatomy::BuildSettings finer = coarse_build;
    finer.spacing = 3e-3f;
    const anatomy::Patient patient = cached_patient({}, finer);
    EXPECT_EQ(files(), 2);
    EXPECT_GT(patient.particles.size(), usual.particles.size());
    const anatomy::Patient built = anatomy::build_patient(NewbornShape{}, finer);
    expect_same_surfaces(patient, built);
    EXPECT_EQ(patient.particles.rest, built.particles.rest);
    EXPECT_EQ(patient.frame_rest_centre, built.frame_rest_centre);
}

TEST_F(PatientCache, AnotherShapeBorrowsNothing) {
    const anatomy::Patient usual = cached_patient({}, coarse_build);
    const anatomy::Patient large = cached_patient({.tongue_scale = 1.2f}, coarse_build);
    EXPECT_NE(large.surfaces[0].mesh.vertices, usual.surfaces[0].mesh.vertices);
    EXPECT_EQ(files(), 2);
}

TEST_F(PatientCache, ADamagedModelLendsNothing) {
    const anatomy::Patient usual = cached_patient({}, coarse_build);
    for (const auto& file : std::filesystem::directory_iterator(folder_)) {
        std::filesystem::resize_file(file.path(), 1000);
    }
    anatomy::BuildSettings finer = coarse_build;
    finer.spacing = 3e-3f;
    expect_same_surfaces(cached_patient({}, finer), anatomy::build_patient(NewbornShape{}, finer));
}

}  // namespace
}  // namespace eti::app
