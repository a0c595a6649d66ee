// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// Every detection of docs/metrics.md, just short of its threshold and just past it; the thresholds are
// repeated here as documented.

#include <gtest/gtest.h>

#include <numbers>

#include "common/math/units.hpp"
#include "played_session.hpp"

namespace eti::metrics {
namespace {

using test::place_blade;
using test::Session;
using test::step;

constexpr float mm = 1e-3f;
constexpr float hair = 0.1f * mm;  // a hundred times the rounding of float positions

/// The blade moves straight in to `depth` past the opening, `aside` from its axis, and leaves after
/// `seconds`.
AttemptMetrics blade_that_went(float depth, float aside = 0.0f, double seconds = 2.0) {
    Session run;
    const auto outside = [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, -0.02f); };
    run.play(0.5, outside);
    run.play(seconds, [&](double, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, depth);
        s.proxy.translation.x() += aside;
    });
    run.play(0.5, outside);
    run.metrics.finish();
    return run.metrics.run().metrics;
}

TEST(NearMisses, AttemptNeedsBladePastLips) {
    EXPECT_EQ(blade_that_went(2 * mm - hair).attempts, 0);
    EXPECT_EQ(blade_that_went(2 * mm + hair).attempts, 1);
}

TEST(NearMisses, BladeBesideFaceIsNoAttempt) {
    EXPECT_EQ(blade_that_went(20 * mm, 30 * mm + hair).attempts, 0);
    EXPECT_EQ(blade_that_went(20 * mm, 30 * mm - hair).attempts, 1);
}

TEST(NearMisses, AttemptNeedsHalfSecondInMouth) {
    EXPECT_EQ(blade_that_went(20 * mm, 0.0f, 0.5 - step).attempts, 0);
    EXPECT_EQ(blade_that_went(20 * mm, 0.0f, 0.5 + step).attempts, 1);
}

TEST(NearMisses, AttemptEndsPastExitThreshold) {
    const auto attempts_with_dip = [](float to) {
        Session run;
        for (const float depth : {-20 * mm, 20 * mm, to, 20 * mm, -20 * mm}) {
            run.play(1.0,
                     [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, depth); });
        }
        return run.metrics.run().metrics.attempts;
    };
    EXPECT_EQ(attempts_with_dip(-2 * mm + hair), 1);
    EXPECT_EQ(attempts_with_dip(-2 * mm - hair), 2);
}

TEST(NearMisses, TimeLimitIsThirtySeconds) {
    EXPECT_EQ(blade_that_went(20 * mm, 0.0f, 30.0 - step).over_time_limit, 0);
    EXPECT_EQ(blade_that_went(20 * mm, 0.0f, 30.0 + step).over_time_limit, 1);
}

TEST(NearMisses, PeakNeedsFiveDegrees) {
    const auto swung = [](float pitch_deg, float yaw_deg) {
        Session run;
        run.play(2.0, [&](double t, scene::Snapshot& s, GlotticView&) {
            const float share = static_cast<float>((1.0 - std::cos(2.0 * std::numbers::pi * t)) / 2.0);
            place_blade(s, run.scope, 20 * mm, (50.0f + share * pitch_deg) * degree,
                        share * yaw_deg * degree);
        });
        return run.metrics.current_metrics();
    };
    EXPECT_EQ(swung(4.99f, 4.99f).pitch_peaks, 0);
    EXPECT_EQ(swung(4.99f, 4.99f).yaw_peaks, 0);
    EXPECT_EQ(swung(5.01f, 0.0f).pitch_peaks, 2);
    EXPECT_EQ(swung(0.0f, 5.01f).yaw_peaks, 2);
}

TEST(NearMisses, FullViewNeedsHalfOpening) {
    const auto with_view = [](float percent) {
        Session run;
        run.play(2.0, [&](double, scene::Snapshot& s, GlotticView& view) {
            place_blade(s, run.scope, 20 * mm);
            view.opening_percent = percent;
        });
        return run.metrics.current_metrics();
    };
    EXPECT_EQ(with_view(49.9f).view_held_s, 0.0);
    EXPECT_EQ(with_view(49.9f).cormack_lehane_grade, 2);
    EXPECT_NEAR(with_view(50.0f).view_held_s, 2.0, 2.5 * step);
    EXPECT_EQ(with_view(50.0f).cormack_lehane_grade, 1);
    EXPECT_TRUE(std::isnan(with_view(0.0f).time_to_first_view_s));
    EXPECT_EQ(with_view(0.0f).cormack_lehane_grade, 4);
}

/// The blade is in, and the tube's tip moves to `end` along a straight line from 20 mm above it.
Session tube_that_went_to(const Vec3f& end) {
    Session run;
    run.play(2.0, [&](double t, scene::Snapshot& s, GlotticView& view) {
        place_blade(s, run.scope, 20 * mm);
        view.opening_percent = 60.0f;
        const Vec3f tip = end + Vec3f(0, 0, 20 * mm * static_cast<float>(std::max(0.0, 1.0 - t)));
        s.tube_nodes = {tip + Vec3f(0, 0, 0.1f), tip};
    });
    return run;
}

AttemptMetrics of_tube(const Vec3f& end) {
    return tube_that_went_to(end).metrics.current_metrics();
}

// The simple airway: the glottis at (0, 35, -60) mm, its plane level; the carina 50 mm below; the oesophagus
// 12 mm behind, its inlet 5 mm lower.
constexpr float glottis_y = 35 * mm, glottis_z = -60 * mm, carina_z = -110 * mm;
constexpr float inlet_y = 47 * mm, inlet_z = -65 * mm;

TEST(NearMisses, TrachealEntryThresholds) {
    const auto place = [](float past, float aside) {
        return tube_that_went_to({aside, glottis_y, glottis_z - past}).metrics.live().tube_place;
    };
    EXPECT_NE(place(2 * mm - hair, 0), TubePlace::trachea);
    EXPECT_EQ(place(2 * mm + hair, 0), TubePlace::trachea);
    EXPECT_NE(place(10 * mm, 6 * mm + hair), TubePlace::trachea);
    EXPECT_EQ(place(10 * mm, 6 * mm - hair), TubePlace::trachea);
}

TEST(NearMisses, OesophagealEntryThresholds) {
    EXPECT_EQ(of_tube({0, inlet_y, inlet_z - 2 * mm + hair}).oesophageal_entries, 0);
    EXPECT_EQ(of_tube({0, inlet_y, inlet_z - 2 * mm - hair}).oesophageal_entries, 1);
    EXPECT_EQ(of_tube({8 * mm + hair, inlet_y, inlet_z - 10 * mm}).oesophageal_entries, 0);
    EXPECT_EQ(of_tube({8 * mm - hair, inlet_y, inlet_z - 10 * mm}).oesophageal_entries, 1);
    // Nearer to the trachea than to the oesophagus: 6 mm is half-way.
    EXPECT_EQ(of_tube({0, inlet_y - 6 * mm - hair, inlet_z - 10 * mm}).oesophageal_entries, 0);
    EXPECT_EQ(of_tube({0, inlet_y - 6 * mm + hair, inlet_z - 10 * mm}).oesophageal_entries, 1);
}

/// Down the trachea to `past` beyond the carina.
Session tube_down_to(float past) {
    Session run;
    run.play(4.0, [&](double t, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, 20 * mm);
        const float way = static_cast<float>(std::max(0.0, 1.0 - t / 3.0));
        const Vec3f tip(0, glottis_y, carina_z - past + way * 70 * mm);
        s.tube_nodes = {tip + Vec3f(0, 0, 0.1f), tip};
    });
    run.metrics.finish();
    return run;
}

TEST(NearMisses, MainStemEntryThreshold) {
    EXPECT_EQ(tube_down_to(1 * mm - hair).metrics.run().metrics.main_stem_entries, 0);
    EXPECT_EQ(tube_down_to(1 * mm + hair).metrics.run().metrics.main_stem_entries, 1);
    // A tube that continues past both lines' ends enters nothing else either.
    const AttemptMetrics far = tube_down_to(40 * mm).metrics.run().metrics;
    EXPECT_EQ(far.main_stem_entries, 1);
    EXPECT_EQ(far.oesophageal_entries, 0);
}

TEST(NearMisses, SuccessNeedsMinimumTubeDepth) {
    EXPECT_FALSE(tube_down_to(-40 * mm - hair).metrics.run().outcome.success);
    EXPECT_TRUE(tube_down_to(-40 * mm + hair).metrics.run().outcome.success);
}

}  // namespace
}  // namespace eti::metrics
