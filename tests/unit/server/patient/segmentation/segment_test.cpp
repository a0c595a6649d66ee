// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/segment.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "coarse_phantom.hpp"
#include "server/patient/segmentation/agreement.hpp"
#include "tests/support/error_of.hpp"

namespace eti::segmentation {
namespace {

using test::coarse_phantom;
using test::silent;

const Structure& structure(const Segmentation& found, const std::string& name) {
    for (const Structure& s : found.structures) {
        if (s.name == name) {
            return s;
        }
    }
    throw std::out_of_range(name);
}

/// Segmentation of the phantom of 1.5 mm in its original orientation, computed once.
const Segmentation& usual_segmentation() {
    static const Segmentation found = segment(coarse_phantom(1.5e-3f).ct, {}, {}, silent);
    return found;
}

/// Compares with the truth, prints the result, and checks it against the required bounds.
void expect_agreement(const Segmentation& found, const Phantom& phantom, const std::string& title) {
    struct Bound {
        const char* name;
        std::vector<Label> labels;
        double dice;
    };
    const std::vector<Label> bone = {Label::bone, Label::mandible, Label::spine};
    for (const Bound& bound :
         {Bound{"airway", {Label::airway}, 0.95}, Bound{"bone", bone, 0.95},
          Bound{"tongue", {Label::tongue}, 0.90}, Bound{"mandible", {Label::mandible}, 0.90},
          // Arches that touch the skull or each other stay bone: the bound is the present result, less a
          // little.
          Bound{"spine", {Label::spine}, 0.85}}) {
        const Agreement a = agreement(found.labels, phantom.labels, bound.labels);
        const double farthest = bound.labels.front() == Label::spine ? 1.2 : 1.0;
        std::printf("%s: %-8s Dice %.3f (at least %.2f), mean surface distance %.2f voxels (below %.1f)\n",
                    title.c_str(), bound.name, a.dice, bound.dice, a.mean_surface_distance.value(), farthest);
        EXPECT_GE(a.dice, bound.dice) << title << ": " << bound.name;
        EXPECT_LT(a.mean_surface_distance.value(), farthest) << title << ": " << bound.name;
        EXPECT_GT(a.voxels_true, 500u) << title << ": " << bound.name << ": nothing to compare";
    }
}

void expect_agreement_of(float weight, float spacing, std::uint64_t seed) {
    const Phantom& phantom = coarse_phantom(spacing, weight, seed);
    const Segmentation found = segment(phantom.ct, {}, {}, silent);
    char title[64];
    std::snprintf(title, sizeof(title), "%.1f kg, %.1f mm", static_cast<double>(weight),
                  1e3 * static_cast<double>(spacing));
    expect_agreement(found, phantom, title);
    EXPECT_TRUE(structure(found, "larynx and trachea").found);
}

TEST(Segment, NoisyPhantomMatchesGroundTruth) {
    expect_agreement_of(3.5f, 1.0e-3f, 1);
}

TEST(WholeSegment, SmallerPhantomMatchesGroundTruth) {
    expect_agreement_of(2.0f, 0.9e-3f, 2);
}

TEST(Segment, ReorderedAxesGiveSameLabels) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Segmentation& usual = usual_segmentation();
    // The same patient, stored with axes in another order and direction.
    imaging::Volume turned;
    imaging::Mask truth;
    const imaging::Geometry& g = phantom.ct.geometry;
    turned.geometry.size = {g.size[2], g.size[0], g.size[1]};
    turned.geometry.step.col(0) = -g.step.col(2);
    turned.geometry.step.col(1) = g.step.col(0);
    turned.geometry.step.col(2) = g.step.col(1);
    turned.geometry.origin = g.point(0, 0, g.size[2] - 1);
    truth.geometry = turned.geometry;
    for (std::size_t i = 0; i < turned.geometry.count(); ++i) {
        const auto [a, b, c] = turned.geometry.coordinates(i);
        const std::size_t j = g.index(b, c, g.size[2] - 1 - a);
        turned.value.push_back(phantom.ct.value[j]);
        truth.value.push_back(usual.labels.value[j]);
    }
    const Segmentation found = segment(turned, {}, {}, silent);
    std::size_t other = 0;
    for (std::size_t i = 0; i < truth.value.size(); ++i) {
        other += truth.value[i] != found.labels.value[i] ? 1 : 0;
    }
    // The grids' origins differ by rounding, and a value next to a threshold may change sides.
    EXPECT_LT(other, truth.value.size() / 10000);
}

/// Compared features of two segmentations.
const std::vector<std::pair<const char*, std::vector<Label>>> organs = {
    {"airway", {Label::airway}},
    {"bone", {Label::bone, Label::mandible, Label::spine}},
    {"mandible", {Label::mandible}},
    {"spine", {Label::spine}},
    {"tongue", {Label::tongue}}};

void expect_the_same_when_turned(const Vec3d& axis, double degrees) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Segmentation& usual = usual_segmentation();
    EXPECT_TRUE(usual.contradictions.empty()) << usual.contradictions.front();
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * M_PI / 180.0, axis.normalized()).toRotationMatrix();
    Phantom turned = phantom;
    turned.ct.geometry.origin = turn * phantom.ct.geometry.origin;
    turned.ct.geometry.step = turn * phantom.ct.geometry.step;
    turned.labels.geometry = turned.ct.geometry;
    const Segmentation found = segment(turned.ct, {}, {}, silent);
    EXPECT_NEAR(found.turn * 180.0 / M_PI, std::fabs(degrees), 3.0);
    EXPECT_TRUE(found.contradictions.empty()) << found.contradictions.front();
    for (const auto& [name, labels] : organs) {
        const double before = agreement(usual.labels, phantom.labels, labels).dice;
        const double after = agreement(found.labels, turned.labels, labels).dice;
        std::printf("turned by %.0f degrees about (%.0f, %.0f, %.0f): %-8s Dice %.3f of %.3f\n", degrees,
                    axis.x(), axis.y(), axis.z(), name, after, before);
        EXPECT_GE(after, 0.9 * before) << name << " at " << degrees << " about " << axis.transpose();
    }
}

TEST(Segment, RotatedPatientKeepsLabels) {
    expect_the_same_when_turned(Vec3d(1, 1, 1), 45.0);
}

TEST(WholeSegment, PatientRotatedAboutEachAxisKeepsLabels) {
    expect_the_same_when_turned(Vec3d(1, 0, 0), 30.0);
    expect_the_same_when_turned(Vec3d(1, 0, 0), -30.0);
    expect_the_same_when_turned(Vec3d(0, 1, 0), 30.0);
    expect_the_same_when_turned(Vec3d(0, 0, 1), -30.0);
}

TEST(Segment, UpsideDownVolumeIsTurnedAndReported) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Segmentation& usual = usual_segmentation();
    imaging::Volume upset = phantom.ct;
    std::reverse(upset.value.begin(), upset.value.end());  // all three axes, which is up, front and left
    imaging::Mask truth = usual.labels;
    std::reverse(truth.value.begin(), truth.value.end());
    const Segmentation found = segment(upset, {}, {}, silent);
    ASSERT_EQ(found.contradictions.size(), 1u);
    EXPECT_NE(found.contradictions.front().find("rotated by 1"), std::string::npos)
        << found.contradictions.front();
    EXPECT_NE(found.contradictions.front().find("Remedy"), std::string::npos) << found.contradictions.front();
    for (const auto& [name, labels] : organs) {
        EXPECT_GT(agreement(found.labels, truth, labels).dice, 0.95) << name;
    }
}

TEST(Segment, TiltedGantryKeepsLabels) {
    // Sampled by the tilted scanner itself: only segment() interpolates.
    PhantomSettings settings;
    settings.spacing = 1.5e-3f;
    settings.gantry_tilt = 20.0f * static_cast<float>(M_PI / 180.0);
    const Phantom tilted = make_phantom(settings, silent);
    ASSERT_LT(std::fabs(tilted.ct.geometry.step.col(1).normalized().dot(Vec3d::UnitY())), 0.95);
    const Segmentation found = segment(tilted.ct, {}, {}, silent);
    EXPECT_TRUE(found.contradictions.empty()) << found.contradictions.front();
    const Segmentation& upright = usual_segmentation();
    for (const auto& [name, labels] : organs) {
        const double before = agreement(upright.labels, coarse_phantom(1.5e-3f).labels, labels).dice;
        const double after = agreement(found.labels, tilted.labels, labels).dice;
        std::printf("gantry tilted by 20 degrees: %-8s Dice %.3f of %.3f\n", name, after, before);
        // Vertebral arches are two voxels thick: interpolation alone parts some of them from their vertebrae.
        EXPECT_GE(after, before - (labels.front() == Label::spine ? 0.15 : 0.03)) << name;
    }
}

TEST(Segment, StrongNoiseLowersConfidence) {
    for (const float noise : {20.0f, 60.0f}) {
        PhantomSettings settings;
        settings.spacing = 1.5e-3f;
        settings.noise = noise;
        const Phantom phantom = make_phantom(settings, silent);
        const Segmentation found = segment(phantom.ct, {}, {}, silent);
        std::printf("noise of %.0f HU: found %.1f HU, contrast to noise %.2f, Dice of the tongue %.3f\n",
                    static_cast<double>(noise), static_cast<double>(found.noise),
                    static_cast<double>(found.tongue_contrast_to_noise),
                    agreement(found.labels, phantom.labels, {Label::tongue}).dice);
        EXPECT_NEAR(found.noise, noise, 0.1f * noise);
        EXPECT_EQ(found.uncertainties.empty(), noise == 20.0f);
    }
}

TEST(Segment, CoarseVoxelsAreNotTrusted) {
    const Segmentation found = segment(coarse_phantom(2.2e-3f).ct, {}, {}, silent);
    for (const char* name : {"mandible", "spine", "tongue"}) {
        EXPECT_FALSE(structure(found, name).found) << name;
        EXPECT_NE(structure(found, name).note.find("voxels of 2.2 mm"), std::string::npos)
            << name << ": " << structure(found, name).note;
    }
    EXPECT_TRUE(structure(found, "airway").found);
    EXPECT_TRUE(found.contradictions.empty());
}

TEST(Segment, PointsInAnotherOrganAreAContradiction) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Points& placed = usual_segmentation().points;
    Points given = placed;
    given["spine"].push_back(placed.at("mandible").back());
    const Segmentation found = segment(phantom.ct, given, {}, silent);
    ASSERT_FALSE(found.contradictions.empty());
    EXPECT_NE(found.contradictions.front().find("'spine'"), std::string::npos)
        << found.contradictions.front();
}

TEST(Segment, PlacedPointsAreAcceptedAsInput) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Points& placed = usual_segmentation().points;
    const Segmentation found = segment(phantom.ct, placed, {}, silent);
    EXPECT_TRUE(found.contradictions.empty()) << found.contradictions.front();
}

TEST(Segment, HeadWithoutNeckHasNoLarynx) {
    const Phantom& whole = coarse_phantom(1.5e-3f);
    const imaging::Geometry& g = whole.ct.geometry;
    // Cut between chin and upper lip: 5 mm below the gum.
    const int cut = static_cast<int>(std::lround(g.to_index(Vec3d(0, 0, -5e-3)).z()));
    imaging::Volume head;
    head.geometry = g;
    head.geometry.size[2] = g.size[2] - cut;
    head.geometry.origin = g.point(0, 0, cut);
    head.value.assign(whole.ct.value.begin() + static_cast<std::ptrdiff_t>(g.index(0, 0, cut)),
                      whole.ct.value.end());
    const Segmentation found = segment(head, {}, {}, silent);
    EXPECT_TRUE(structure(found, "bone").found);
    for (const char* name : {"larynx and trachea", "mandible", "tongue"}) {
        EXPECT_FALSE(structure(found, name).found) << name;
        EXPECT_FALSE(structure(found, name).note.empty()) << name;
    }
    EXPECT_EQ(std::count(found.labels.value.begin(), found.labels.value.end(), value_of(Label::mandible)), 0);
    EXPECT_EQ(std::count(found.labels.value.begin(), found.labels.value.end(), value_of(Label::tongue)), 0);
}

TEST(Segment, GivenLandmarksAreUsed) {
    const Phantom& phantom = coarse_phantom(1.5e-3f);
    const Segmentation& usual = usual_segmentation();
    // The level set finds the tongue from any seed within it.
    const Points given = {{"tongue", {usual.points.at("tongue").front() + Vec3d(3e-3, 4e-3, -2e-3)}}};
    const Segmentation found = segment(phantom.ct, given, {}, silent);
    EXPECT_GT(agreement(found.labels, usual.labels, {Label::tongue}).dice, 0.98);
    EXPECT_THROW((void)segment(phantom.ct, {{"tongue", {Vec3d(1, 0, 0)}}}, {}, silent), imaging::VolumeError);
}

TEST(Segment, NonCtVolumesAreRefused) {
    Phantom phantom = coarse_phantom(2.5e-3f);
    imaging::Volume swapped = phantom.ct;
    for (float& v : swapped.value) {
        const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(v));
        v = static_cast<float>(static_cast<std::int16_t>(bits >> 8 | bits << 8));
    }
    const auto refused = [](const imaging::Volume& volume, const std::string& said) {
        EXPECT_THAT(eti::test::error_of<imaging::VolumeError>([&] { (void)segment(volume, {}, {}, silent); }),
                    ::testing::HasSubstr(said));
    };
    refused(swapped, "endian");
    std::fill(phantom.ct.value.begin(), phantom.ct.value.end(), 40.0f);
    refused(phantom.ct, "air");
}

TEST(Segment, StopsOnRequest) {
    const Phantom& phantom = coarse_phantom(2.0e-3f);
    for (int after = 0; after < 6; ++after) {
        int heard = 0;
        EXPECT_THROW(
            (void)segment(phantom.ct, {}, {}, [&](float, std::string_view) { return heard++ < after; }),
            CancelledError);
    }
}

}  // namespace
}  // namespace eti::segmentation
