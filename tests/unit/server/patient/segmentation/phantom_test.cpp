// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>

#include "coarse_phantom.hpp"

namespace eti::segmentation {
namespace {

using test::coarse_phantom;

TEST(Phantom, NoiseIsReproducibleBySeed) {
    const Phantom& a = coarse_phantom(2.5e-3f);
    PhantomSettings again;
    again.spacing = 2.5e-3f;
    EXPECT_EQ(a.ct.value, make_phantom(again, test::silent).ct.value);
    const Phantom& b = coarse_phantom(2.5e-3f, 3.5f, 2);
    EXPECT_EQ(a.labels.value, b.labels.value);
    EXPECT_NE(a.ct.value, b.ct.value);
}

TEST(Phantom, TongueContrastIsBelowNoise) {
    const Phantom& phantom = coarse_phantom(2.5e-3f);
    const auto mean_of = [&](Label label) {
        double sum = 0.0, count = 0.0;
        for (std::size_t i = 0; i < phantom.ct.value.size(); ++i) {
            // Partial-volume voxels with air or bone belong to no single tissue.
            const auto v = static_cast<double>(phantom.ct.value[i]);
            if (phantom.labels.value[i] == value_of(label) && std::abs(v - 40.0) < 100.0) {
                sum += v;
                count += 1.0;
            }
        }
        EXPECT_GT(count, 500.0);
        return sum / count;
    };
    const double contrast = std::abs(mean_of(Label::tongue) - mean_of(Label::soft));
    EXPECT_LE(contrast, static_cast<double>(PhantomSettings().noise));
    EXPECT_GT(contrast, 1.0);
}

TEST(Phantom, NoiseHasRequestedStandardDeviation) {
    const Phantom& phantom = coarse_phantom(2.0e-3f);
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    // Far from borders, without partial-volume voxels: the outer air at the volume's front.
    for (std::size_t i = 0; i < 3000; ++i) {
        ASSERT_EQ(phantom.labels.value[phantom.labels.value.size() - 1 - i], value_of(Label::outside));
        const double v = phantom.ct.value[phantom.ct.value.size() - 1 - i];
        sum += v;
        squares += v * v;
        count += 1.0;
    }
    const double mean = sum / count;
    // Three standard errors: 20 / sqrt(3000) and 20 / sqrt(6000).
    EXPECT_NEAR(mean, -1000.0, 1.1);
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 20.0, 0.8);
}

TEST(Phantom, BorderVoxelsShowPartialVolume) {
    PhantomSettings settings;
    settings.spacing = 2.0e-3f;
    settings.noise = 0.0f;
    const Phantom phantom = make_phantom(settings, test::silent);
    std::size_t mixed = 0;
    for (std::size_t i = 0; i < phantom.ct.value.size(); ++i) {
        const auto label = static_cast<Label>(phantom.labels.value[i]);
        mixed += phantom.ct.value[i] != hounsfield_of(label) ? 1 : 0;
        // The label has the largest share: a voxel labelled air holds air.
        if (label == Label::outside || label == Label::airway) {
            ASSERT_LT(phantom.ct.value[i], 40.0f);
        }
    }
    EXPECT_GT(mixed, phantom.ct.value.size() / 100);
    EXPECT_LT(mixed, phantom.ct.value.size() / 2);
}

TEST(Phantom, LandmarksLieInTheirStructures) {
    const Phantom& phantom = coarse_phantom(2.0e-3f);
    const auto label_at = [&](const char* name) {
        const Vec3d at = phantom.labels.geometry.to_index(phantom.landmarks.at(name).front());
        return static_cast<Label>(phantom.labels.at(static_cast<int>(std::lround(at.x())),
                                                    static_cast<int>(std::lround(at.y())),
                                                    static_cast<int>(std::lround(at.z()))));
    };
    EXPECT_EQ(label_at("trachea_mid"), Label::airway);
    EXPECT_EQ(label_at("glottis"), Label::airway);
}

TEST(Phantom, StopsOnRequest) {
    EXPECT_THROW((void)make_phantom({}, [](float, std::string_view) { return false; }), CancelledError);
}

}  // namespace
}  // namespace eti::segmentation
