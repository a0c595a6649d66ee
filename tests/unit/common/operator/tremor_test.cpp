// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/operator/track_player.hpp"
#include "tests/unit/common/operator/newborn_landmarks.hpp"

namespace eti {
namespace {

constexpr float rms = 0.5e-3f;
constexpr double seconds = 64.0;
constexpr double rate = 128.0;

// Position of a resting hand, so that all motion is tremor [m]; a sample every 1/128 s.
std::vector<Vec3d> trembling(std::uint64_t seed, int calls_per_sample = 1) {
    Track track;
    track.stages.emplace_back();
    TrackPlayer player(track, 0.1f, rms, 0.2f, seed);
    Observation seen;
    seen.landmarks = newborn_landmarks();
    std::vector<Vec3d> samples;
    constexpr double settled = 10.0;  // the only stage has long ended
    for (int i = 0; i < static_cast<int>((settled + seconds) * rate); ++i) {
        for (int call = calls_per_sample - 1; call >= 0; --call) {
            seen.time = (i - static_cast<double>(call) / calls_per_sample) / rate;
            if (seen.time < 0) {
                continue;
            }
            const RigidTransform pose = player.wanted(seen);
            if (call == 0 && seen.time >= settled) {
                samples.push_back(pose.translation.cast<double>());
            }
        }
    }
    Vec3d mean = Vec3d::Zero();
    for (const Vec3d& p : samples) {
        mean += p / static_cast<double>(samples.size());
    }
    for (Vec3d& p : samples) {
        p -= mean;
    }
    return samples;
}

// Power per axis and hertz, summed over axes, by the discrete Fourier transform at one frequency.
double power(const std::vector<Vec3d>& samples, double frequency) {
    Vec3d re = Vec3d::Zero(), im = Vec3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double angle = 2 * 3.14159265358979 * frequency * static_cast<double>(i) / rate;
        re += std::cos(angle) * samples[i];
        im += std::sin(angle) * samples[i];
    }
    return (re.squaredNorm() + im.squaredNorm()) * 2 /
           (static_cast<double>(samples.size()) * static_cast<double>(samples.size()));
}

TEST(Tremor, HasTheRmsAskedFor) {
    double sum = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        for (const Vec3d& p : trembling(seed)) {
            sum += p.squaredNorm();
            ++count;
        }
    }
    // Cross terms of two sines df apart average to at most 1/(2 pi df T) of their power; with 6 lines in 4 Hz
    // over 64 s and eight seeds their sum scatters by a few per cent.
    EXPECT_NEAR(std::sqrt(sum / count) / static_cast<double>(rms), 1.0, 0.05);
}

TEST(Tremor, LiesBetweenEightAndTwelveHertz) {
    const std::vector<Vec3d> samples = trembling(3);
    double inside = 0, outside = 0;
    for (double f = 1.0 / seconds; f < rate / 2; f += 1.0 / seconds) {
        // One bin more on each side for a line that falls between bins.
        (f > 8 - 1.5 / seconds && f < 12 + 1.5 / seconds ? inside : outside) += power(samples, f);
    }
    // Leakage of a line between bins falls with the square of the distance: under 2 % beyond the margin
    // even if all lines stood at the edge.
    EXPECT_LT(outside, 0.05 * inside);
    EXPECT_GT(inside, 0.5 * static_cast<double>(rms * rms));
}

TEST(Tremor, DependsOnSeedAndTimeAlone) {
    const auto once = trembling(5), again = trembling(5), often = trembling(5, 7), other = trembling(6);
    double apart = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
        ASSERT_EQ(once[i], again[i]);
        // The mean differs by rounding only.
        ASSERT_LT((once[i] - often[i]).norm(), 1e-8) << "the tremor depends on how often it is asked for";
        apart = std::max(apart, (once[i] - other[i]).norm());
    }
    EXPECT_GT(apart, static_cast<double>(rms));
}

}  // namespace
}  // namespace eti
