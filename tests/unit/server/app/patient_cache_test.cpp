// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/patient_cache.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace eti::app {
namespace {

/// Surfaces that are only compared for equality.
constexpr patient::BuildSettings rough{
    .spacing = 3.5e-3f, .fine_spacing = 2e-3f, .surface_spacing = 5e-3f, .body_triangles = 10000};

patient::BuildSettings with_spacing(float spacing) {
    patient::BuildSettings settings = rough;
    settings.spacing = spacing;
    return settings;
}

/// A cache of its own for each test, initialised with what the default newborn left in an empty one.
class PatientCache : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        const std::filesystem::path folder = folder_of("first");
        std::filesystem::create_directories(folder);
        ::setenv("ETI_CACHE", folder.c_str(), 1);
        usual_ = std::make_unique<patient::Patient>(cached_patient({}, rough));
        finer_ =
            std::make_unique<patient::Patient>(patient::build_patient(NewbornShape{}, with_spacing(3e-3f)));
    }
    static void TearDownTestSuite() {
        std::filesystem::remove_all(folder_of("first"));
        usual_.reset();
        finer_.reset();
    }
    PatientCache() {
        std::filesystem::copy(folder_of("first"), folder_);
        ::setenv("ETI_CACHE", folder_.c_str(), 1);
    }
    ~PatientCache() override {
        ::unsetenv("ETI_CACHE");
        std::filesystem::remove_all(folder_);
    }
    static std::filesystem::path folder_of(const std::string& name) {
        return std::filesystem::temp_directory_path() / ("eti_cache_" + name + std::to_string(::getpid()));
    }
    [[nodiscard]] std::ptrdiff_t files() const {
        return std::distance(std::filesystem::directory_iterator(folder_), {});
    }
    std::filesystem::path folder_ = folder_of("");
    static std::unique_ptr<patient::Patient> usual_;  ///< as built with an empty cache
    static std::unique_ptr<patient::Patient> finer_;  ///< with another particle spacing, built from scratch
};
std::unique_ptr<patient::Patient> PatientCache::usual_;
std::unique_ptr<patient::Patient> PatientCache::finer_;

void expect_same_surfaces(const patient::Patient& a, const patient::Patient& b) {
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

TEST_F(PatientCache, BuiltModelIsReused) {
    EXPECT_EQ(files(), 1);
    const patient::Patient read = cached_patient({}, rough);
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(read.particles.rest, usual_->particles.rest);
    expect_same_surfaces(read, *usual_);
}

TEST_F(PatientCache, StiffnessChangeReusesModel) {
    patient::BuildSettings settings = rough;
    settings.tissue_stiffness = 12e3f;
    const patient::Patient stiff = cached_patient({}, settings);
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(stiff.tissue_stiffness, 12e3f);
    ASSERT_EQ(stiff.links.ends, usual_->links.ends);
    for (std::size_t l = 0; l < stiff.links.ends.size(); ++l) {
        const bool of_epiglottis = std::ranges::any_of(stiff.links.ends[l], [&](std::uint32_t i) {
            return stiff.particles.tissue[i] == Tissue::epiglottis;
        });
        EXPECT_EQ(stiff.links.stiffness[l], (of_epiglottis ? 1.0f : 1.5f) * usual_->links.stiffness[l]);
    }
    expect_same_surfaces(stiff, *usual_);
}

// Reference: the same built from scratch.
TEST_F(PatientCache, OtherSpacingReusesSurfaces) {
    const patient::Patient patient = cached_patient({}, with_spacing(3e-3f));
    EXPECT_EQ(files(), 2);
    EXPECT_GT(patient.particles.size(), usual_->particles.size());
    expect_same_surfaces(patient, *finer_);
    EXPECT_EQ(patient.particles.rest, finer_->particles.rest);
    EXPECT_EQ(patient.frame_rest_centre, finer_->frame_rest_centre);
}

TEST_F(PatientCache, OtherShapeIsBuiltFromScratch) {
    const patient::Patient large = cached_patient({.tongue_scale = 1.2f}, rough);
    EXPECT_NE(large.surfaces[0].mesh.vertices, usual_->surfaces[0].mesh.vertices);
    EXPECT_EQ(files(), 2);
}

TEST_F(PatientCache, CorruptModelIsNotReused) {
    for (const auto& file : std::filesystem::directory_iterator(folder_)) {
        std::filesystem::resize_file(file.path(), 1000);
    }
    expect_same_surfaces(cached_patient({}, with_spacing(3e-3f)), *finer_);
}

/// Environment variables are set as for a home in which nothing can be created.
class CacheFolder : public ::testing::Test {
  protected:
    CacheFolder() {
        std::filesystem::create_directories(temporary_);
        ::unsetenv("ETI_CACHE");
        ::unsetenv("XDG_CACHE_HOME");
        ::setenv("HOME", "/proc/nobody", 1);
        ::setenv("TMPDIR", temporary_.c_str(), 1);
    }
    ~CacheFolder() override {
        std::filesystem::remove_all(temporary_);
        for (const auto& [name, value] : before_) {
            value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
        }
    }
    static std::optional<std::string> value_of(const char* name) {
        const char* const value = std::getenv(name);
        return value == nullptr ? std::nullopt : std::optional<std::string>(value);
    }
    std::filesystem::path temporary_ =
        std::filesystem::temp_directory_path() / ("eti_cache_folder_" + std::to_string(::getpid()));
    std::filesystem::path own_ = temporary_ / ("neoeti-" + std::to_string(::getuid()));
    std::map<const char*, std::optional<std::string>> before_ = {
        {"HOME", value_of("HOME")},
        {"TMPDIR", value_of("TMPDIR")},
        {"XDG_CACHE_HOME", value_of("XDG_CACHE_HOME")}};
};

TEST_F(CacheFolder, IsTemporaryWithoutWritableHome) {
    EXPECT_EQ(cache_folder(), own_);
    EXPECT_EQ(std::filesystem::status(own_).permissions(), std::filesystem::perms::owner_all);
}

TEST_F(CacheFolder, FolderThatOthersMayWriteIsNotUsed) {
    std::filesystem::create_directories(own_);
    std::filesystem::permissions(own_, std::filesystem::perms::all);
    EXPECT_EQ(cache_folder(), "/proc/nobody/.cache/neoeti");
}

TEST_F(CacheFolder, LinkIsNotFollowed) {
    std::filesystem::create_directories(temporary_ / "elsewhere");
    std::filesystem::create_directory_symlink(temporary_ / "elsewhere", own_);
    EXPECT_EQ(cache_folder(), "/proc/nobody/.cache/neoeti");
}

}  // namespace
}  // namespace eti::app
