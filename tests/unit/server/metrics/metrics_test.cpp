// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string_view>

#include "common/math/units.hpp"
#include "played_session.hpp"

namespace eti::metrics {
namespace {

using test::place_blade;
using test::Session;
using test::step;

TEST(Metrics, AttemptLastsFromBladeInToBladeOut) {
    Session run;
    const auto to_and_fro = [&](double t, scene::Snapshot& s, GlotticView&) {
        // 50 mm/s in from 20 mm before the plane to 40 mm past it, and out.
        place_blade(s, run.scope, static_cast<float>(t < 1.2 ? -0.02 + 0.05 * t : 0.04 - 0.05 * (t - 1.2)));
    };
    run.play(2.4, to_and_fro);
    run.play(2.4, to_and_fro);
    ASSERT_EQ(run.metrics.attempts().size(), 2u);
    const AttemptSummary& first = run.metrics.attempts()[0];
    // In at +2 mm, 22 mm along the way in; out at -2 mm, 42 mm along the way back. Each is detected up to a
    // step late.
    const double in = 0.022 / 0.05;
    const double out = 1.2 + 0.042 / 0.05;
    EXPECT_NEAR(first.began, in, step);
    EXPECT_NEAR(first.ended, out, step);
    EXPECT_NEAR(first.metrics.time_s, out - in, step);
    EXPECT_EQ(run.metrics.run().metrics.attempts, 2);
    EXPECT_NEAR(run.metrics.run().metrics.time_s, 2 * (out - in), 2 * step);

    // Depth: straight from the gum at the origin to a tip at (0, y, -10 mm). Maximum at y = 30 mm; the mean
    // by the closed form of the integral of sqrt(y^2 + a^2).
    const double a = 0.01;
    const auto primitive = [a](double y) { return 0.5 * (y * std::hypot(y, a) + a * a * std::asinh(y / a)); };
    const double path = (0.03 + 0.008) + (0.03 + 0.012);  // y from -8 to 30 mm, and back to -12 mm
    const double mean = (2 * primitive(0.03) - primitive(-0.008) - primitive(-0.012)) / path;
    EXPECT_NEAR(first.metrics.blade_depth_max_cm, 100 * std::hypot(0.03, a), 0.03);  // a step is 0.28 mm
    EXPECT_NEAR(first.metrics.blade_depth_mean_cm, 100 * mean, 0.03);
    // The path is sampled at 30 Hz; the turn and the two ends lose at most an interval of 1.7 mm each.
    EXPECT_NEAR(first.metrics.blade_path_length_cm, 100 * path, 3 * 0.17);
}

TEST(Metrics, BriefTouchIsNoAttempt) {
    Session run;
    const auto outside = [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, -0.02f); };
    const auto inside = [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, 0.01f); };
    run.play(1.0, outside);
    run.play(6.0 * step, inside);  // 33 ms
    EXPECT_TRUE(run.metrics.live().attempt_running);
    run.play(1.0, outside);
    EXPECT_FALSE(run.metrics.live().attempt_running);
    EXPECT_EQ(run.metrics.live().attempt, 0u);
    EXPECT_EQ(run.metrics.attempts().size(), 0u);
    EXPECT_EQ(run.metrics.run().metrics.attempts, 0.0);
    EXPECT_EQ(run.metrics.events().back().text,
              "attempt 1 does not count: the blade was in the mouth for 0.03 s");
    run.play(0.6, inside);
    run.play(0.1, outside);
    ASSERT_EQ(run.metrics.attempts().size(), 1u);
    EXPECT_EQ(run.metrics.attempts()[0].number, 1u);
}

TEST(Metrics, ViewHoldTimeAndForceImpulses) {
    Session run;
    run.play(4.0, [&](double t, scene::Snapshot& s, GlotticView& v) {
        place_blade(s, run.scope, 0.03f);
        v.opening_percent = t < 1.0 ? 0.0f : t < 2.0 ? 49.0f : 51.0f;
        s.shell_contacts.clear();
        s.shell_contacts.push_back(
            {Vec3f::Zero(), Vec3f::UnitZ(), 2.0f * static_cast<float>(t), Tissue::upper_gum});
        s.shell_contacts.push_back({Vec3f::Zero(), Vec3f::UnitZ(), 1.5f, Tissue::tongue});
        s.shell_contacts.push_back({Vec3f::Zero(), Vec3f::UnitZ(), 0.5f, Tissue::epiglottis});
    });
    const AttemptMetrics p = run.metrics.current_metrics();
    EXPECT_NEAR(p.view_held_s, 2.0, 2.0 * step);
    EXPECT_NEAR(p.gum_impulse_n_s, 16.0, 16.0 * 2.0 * step / 4.0 + 1e-6);  // integral of 2 t over 4 s
    EXPECT_NEAR(p.tongue_impulse_n_s, 6.0, 1.5 * step + 1e-6);
    EXPECT_NEAR(p.epiglottis_impulse_n_s, 2.0, 0.5 * step + 1e-6);
}

TEST(Metrics, HandSpeedDiffersFromTipSpeed) {
    Session run;
    const test::Path path = test::tracheal_path();
    run.play(3.0, [&](double t, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, 0.03f);
        // The tip jumps by 20 mm within a tenth of a second, while the hand continues at 10 mm/s.
        const double tip = 0.17 + 0.01 * t + (t > 1.0 ? std::min(0.02, 0.2 * (t - 1.0)) : 0.0);
        s.tube_nodes = test::tube_on(path, static_cast<float>(tip));
        s.tube_grip.translation = Vec3f(0, 0, static_cast<float>(0.01 * t));
    });
    const AttemptMetrics p = run.metrics.current_metrics();
    EXPECT_NEAR(p.tube_speed_max_cm_per_s, 21.0, 0.5);
    EXPECT_NEAR(p.tube_grip_speed_max_cm_per_s, 1.0, 0.01);
    EXPECT_NEAR(p.tube_grip_speed_mean_cm_per_s, 1.0, 0.01);
}

TEST(Metrics, VitalSignsFallDuringAttemptAndRecover) {
    Session run;
    run.metrics.begin(run.patient, run.scope, 30.0, physiology::newborn_physiology(3.0, 39.0, 0.21));
    const auto outside = [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, -0.05f); };
    const auto inside = [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, 0.03f); };
    run.play(5.0, outside);
    const double rest = run.metrics.current_metrics().oxygen_saturation_end_percent;
    EXPECT_GT(rest, 97.0);
    EXPECT_TRUE(std::isnan(run.metrics.current_metrics().oxygen_saturation_min_percent)) << "no attempt yet";
    run.play(40.0, inside);
    const AttemptMetrics low = run.metrics.current_metrics();
    EXPECT_LT(low.oxygen_saturation_end_percent, 80.0);
    EXPECT_NEAR(low.oxygen_saturation_min_percent, low.oxygen_saturation_end_percent, 1e-9)
        << "it still falls";
    EXPECT_LT(low.heart_rate_end_per_min, run.metrics.current_metrics().heart_rate_min_per_min + 1e-9);
    run.play(60.0, outside);
    ASSERT_EQ(run.metrics.attempts().size(), 1u);
    const AttemptMetrics of_run = run.metrics.run().metrics;
    EXPECT_NEAR(of_run.oxygen_saturation_end_percent, rest, 0.5);
    EXPECT_NEAR(of_run.oxygen_saturation_min_percent, low.oxygen_saturation_min_percent, 0.5);
    const auto said = [&](std::string_view text) {
        return std::ranges::count(run.metrics.events(), text, &Event::text);
    };
    EXPECT_EQ(said("attempt 1 takes longer than 30 s"), 1);
    EXPECT_EQ(said("the oxygen saturation fell below 80 %"), 1);
    EXPECT_EQ(said("the oxygen saturation is above 80 % again"), 1);
}

TEST(Metrics, NoVitalSignsWithoutPhysiology) {
    Session run;
    run.play(2.0, [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, 0.03f); });
    EXPECT_TRUE(std::isnan(run.metrics.current_metrics().oxygen_saturation_end_percent));
    EXPECT_TRUE(std::isnan(run.metrics.current_metrics().heart_rate_min_per_min));
}

TEST(Metrics, ForcesAreAggregatedPerTissue) {
    Session run;
    float tongue_force = 0.0f;
    run.play(0.5, [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, -0.05f); });
    run.play(6.0, [&](double t, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, 0.03f);
        s.shell_contacts.clear();
        s.tissue_contacts.clear();
        if (t < 2.0) {
            s.shell_contacts.push_back({Vec3f::Zero(), Vec3f::UnitZ(), 2.0f, Tissue::upper_gum});
            s.shell_contacts.push_back({Vec3f::Zero(), Vec3f::UnitZ(), 1.0f, Tissue::upper_gum});
            s.shell_contacts.push_back({Vec3f::Zero(), Vec3f::UnitZ(), 9.0f, Tissue::lower_gum});
            scene::TissueContact particle;
            particle.tissue = Tissue::upper_gum;
            particle.force = {0.3f, 0, 0.4f};
            s.tissue_contacts.push_back(particle);
            particle.tissue = Tissue::epiglottis;
            particle.force = {0, 0, 1.5f};
            s.tissue_contacts.push_back(particle);
            s.tissue_contacts.push_back(particle);
            particle.tissue = Tissue::tongue;
            particle.force = {0, 2.0f, 0};
            s.tissue_contacts.push_back(particle);
            particle.force = {0, 2.0f, 1.5f};
            s.tissue_contacts.push_back(particle);
        }
        tongue_force = std::max(tongue_force, run.metrics.live().measures.tongue_force_n);
    });
    EXPECT_NEAR(tongue_force, std::hypot(4.0, 1.5), 1e-6);
    EXPECT_EQ(run.metrics.live().measures.tongue_force_n, 0.0f) << "no longer touched";
    run.metrics.finish();
    const AttemptMetrics& p = run.metrics.attempts()[0].metrics;
    EXPECT_NEAR(p.gum_force_max_n, 3.5, 1e-6);
    EXPECT_NEAR(p.gum_force_mean_n, 3.5 / 3, 3.5 * step / 6);
    EXPECT_NEAR(p.epiglottis_force_max_n, 3.0, 1e-6);
    EXPECT_NEAR(p.tongue_force_max_n, std::hypot(4.0, 1.5), 1e-6);
}

TEST(Metrics, PeaksAreCountedInTheSkullFrame) {
    Session run;
    const Quatf turned(Eigen::AngleAxisf(0.5f, Vec3f::UnitX()));
    run.play(10.0, [&](double t, scene::Snapshot& s, GlotticView&) {
        const double pitch = 60 - 4 * std::cos(2 * std::numbers::pi * 0.5 * t);  // five maxima, 8 deg each
        const double yaw =
            -6 * (1 - std::cos(2 * std::numbers::pi * 0.2 * t)) / 2;  // two swings to the right
        s.frames[1].rotation = turned;
        place_blade(s, run.scope, 0.03f, static_cast<float>(pitch) * degree,
                    static_cast<float>(yaw) * degree);
        const Vec3f tip = s.proxy * run.scope.tip();
        s.proxy.rotation = turned * s.proxy.rotation;
        s.proxy.translation = tip - s.proxy.rotation * run.scope.tip();
    });
    run.metrics.finish();
    const AttemptMetrics& p = run.metrics.attempts()[0].metrics;
    EXPECT_EQ(p.pitch_peaks, 5);
    EXPECT_EQ(p.yaw_peaks, 2);
}

TEST(Metrics, RockingDistinguishesShakenFromSteadyBlade) {
    const auto rocking_of = [](double amplitude_deg) {
        Session run;
        run.play(12.0, [&](double t, scene::Snapshot& s, GlotticView&) {
            const double swing = 50 + 10 * std::sin(0.5 * t);
            const double shake = amplitude_deg * std::sin(2 * std::numbers::pi * 3.1 * t);
            place_blade(s, run.scope, 0.03f, static_cast<float>(swing + shake) * degree);
        });
        run.metrics.finish();
        return run.metrics.attempts()[0].metrics.pitch_rocking_deg;
    };
    EXPECT_LT(rocking_of(0.0), 0.1);
    // At 3.1 Hz the shake lies in the finest band and is removed completely; bins of 0.1 s pass sinc(0.31) =
    // 0.85 of it. The residual's maximum may exceed the amplitude where wavelets overlap.
    EXPECT_GT(rocking_of(3.0), 0.85 * 3.0 * 0.8);
    EXPECT_LT(rocking_of(3.0), 3.0 * 1.6);
}

TEST(Metrics, ViewIsAveragedFromFirstSightToTubeArrival) {
    Session run;
    const test::Path path = test::tracheal_path();
    const float glottis = path.length_to(2);
    run.snapshot.runtime_parameters.head_elevation = 5 * degree;
    run.play(10.0, [&](double t, scene::Snapshot& s, GlotticView& view) {
        place_blade(s, run.scope, 0.03f);
        view.opening_percent = t < 2 ? 0.0f : t < 5 ? 20.0f : 80.0f;
        s.runtime_parameters.head_elevation = (t < 5 ? 5.0f : t < 8 ? 12.0f : 17.0f) * degree;
        // 10 mm/s; 6 mm before the glottis at t = 7 s, 2 mm past it at 7.8 s.
        s.tube_nodes = test::tube_on(path, glottis - 0.006f + 0.01f * static_cast<float>(t - 7));
    });
    run.metrics.finish();
    const AttemptMetrics& p = run.metrics.attempts()[0].metrics;
    EXPECT_NEAR(p.glottic_opening_max_percent, 80.0, 1e-6);
    EXPECT_NEAR(p.glottic_opening_mean_percent, (3 * 20 + 2 * 80) / 5.0, 80 * 3 * step / 5);
    EXPECT_NEAR(p.time_to_first_view_s, 2.0, 2 * step);  // the blade is in from the first step on
    EXPECT_NEAR(p.head_elevation_deg, 12.0, 1e-4);       // at passage, not at the end
    EXPECT_EQ(p.cormack_lehane_grade, 1);
}

// The same tool motions in a newborn and in a manikin: metrics derived from them are equal to the bit, and no
// others exist. The paper's eight are counted by their names, as two of them are a maximum and a mean.
TEST(Metrics, ManikinReportsOnlyToolMetrics) {
    const auto play = [](PatientKind of) {
        auto run = std::make_unique<Session>();
        run->metrics.begin(run->patient, run->scope, 30.0, std::nullopt, of);
        const test::Path path = test::tracheal_path();
        run->play(2.0, [&](double t, scene::Snapshot& s, GlotticView& view) {
            place_blade(s, run->scope, static_cast<float>(0.03 - 0.01 * t));
            view.opening_percent = of == PatientKind::newborn ? 60.0f : 0.0f;
            s.tube_nodes = test::tube_on(path, path.length_to(2) + static_cast<float>(0.01 * t));
        });
        run->metrics.finish();
        return run;
    };
    const auto newborn = play(PatientKind::newborn), manikin = play(PatientKind::manikin);
    ASSERT_EQ(manikin->metrics.attempts().size(), 1u);
    const AttemptMetrics in_newborn = newborn->metrics.run().metrics;
    std::set<std::string_view> of_paper;
    for (const AttemptMetrics& p : {manikin->metrics.run().metrics, manikin->metrics.attempts()[0].metrics,
                                    manikin->metrics.current_metrics()}) {
        for (const MetricField& field : metric_fields) {
            const double value = p.*field.value;
            if (!depends_only_on_tool_poses(field)) {
                EXPECT_TRUE(std::isnan(value)) << field.key;
            } else {
                // The tube's speeds exist in neither: no grip moves this tube.
                const double usual = in_newborn.*field.value;
                EXPECT_TRUE(value == usual || (std::isnan(value) && std::isnan(usual)))
                    << field.key << ": " << value << " and " << usual;
                if (field.in_paper) {
                    of_paper.insert(field.key.substr(0, field.key.find('.')));
                }
            }
        }
    }
    EXPECT_EQ(of_paper.size(), 8u);
    EXPECT_TRUE(newborn->metrics.run().outcome.known);
    EXPECT_FALSE(manikin->metrics.run().outcome.known);
    EXPECT_FALSE(manikin->metrics.attempts()[0].outcome.known);
    for (const Session* run : {newborn.get(), manikin.get()}) {  // how a client distinguishes them
        const metrics::Metrics& m = run->metrics;
        EXPECT_EQ(airway_measured(m.run().metrics), m.run().outcome.known);
        EXPECT_EQ(airway_measured(m.attempts()[0].metrics), m.attempts()[0].outcome.known);
        EXPECT_EQ(airway_measured(m.current_metrics()), m.run().outcome.known);
    }
    for (const Event& event : manikin->metrics.events()) {
        EXPECT_EQ(event.text.find("the tube"), std::string::npos) << event.text;
    }
}

TEST(Metrics, SuccessfulIntubation) {
    Session run;
    run.metrics.begin(run.patient, run.scope, 30.0, physiology::newborn_physiology(3.0, 39.0, 0.3));
    const test::Path path = test::tracheal_path();
    const float from = path.length_to(1) - 0.01f;
    const float to = path.length_to(2) + 0.021f;
    run.play(1.0, [&](double, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, 0.03f);
        s.tube_nodes = test::tube_on(path, from);
    });
    const double speed = 0.02;
    const double travel = static_cast<double>(to - from) / speed;
    run.play(travel, [&](double t, scene::Snapshot& s, GlotticView& view) {
        view.opening_percent = 60.0f;
        s.tube_nodes = test::tube_on(path, from + static_cast<float>(speed * t));
    });
    run.play(1.0, [&](double t, scene::Snapshot& s, GlotticView&) {
        place_blade(s, run.scope, static_cast<float>(0.03 - 0.06 * t));
    });
    ASSERT_EQ(run.metrics.attempts().size(), 1u);
    const AttemptSummary& attempt = run.metrics.attempts()[0];
    EXPECT_TRUE(attempt.outcome.success);
    EXPECT_EQ(run.metrics.live().tube_place, TubePlace::trachea);
    EXPECT_EQ(attempt.outcome.reason, "the tube's tip lies 21 mm past the glottis, 29 mm above the carina");
    EXPECT_EQ(run.metrics.run().outcome.reason, attempt.outcome.reason);
    const AttemptMetrics& p = attempt.metrics;
    // Mean over the path inside the mouth and the rest after it; the path's corners shorten a chord.
    const double inside = (static_cast<double>(to - from) - 0.012) / speed;
    const double resting = attempt.ended - 1.0 - travel;
    EXPECT_NEAR(p.tube_speed_max_cm_per_s, 2.0, 0.01);
    EXPECT_NEAR(p.tube_speed_mean_cm_per_s, 2.0 * inside / (inside + resting), 0.05);
    EXPECT_NEAR(p.tube_depth_at_lip_cm, 100.0 * static_cast<double>(to - path.length_to(1)), 0.05);
    EXPECT_EQ(p.tube_depth_rule_cm, 9.0);
    EXPECT_EQ(p.oesophageal_entries, 0);
    EXPECT_EQ(p.main_stem_entries, 0);
    EXPECT_EQ(p.over_time_limit, 0);
    for (const MetricField& field : metric_fields) {
        EXPECT_FALSE(std::isnan(run.metrics.run().metrics.*field.value)) << field.key;
    }
}

TEST(Metrics, OesophagealIntubationIsReported) {
    Session run;
    const test::Path path = test::oesophageal_path();
    const float inlet = path.length_to(2);
    run.play(4.0, [&](double t, scene::Snapshot& s, GlotticView& view) {
        place_blade(s, run.scope, 0.03f);
        view.opening_percent = 10.0f;
        s.tube_nodes = test::tube_on(path, inlet - 0.03f + 0.02f * static_cast<float>(t));
    });
    run.metrics.finish();
    const AttemptSummary run_summary = run.metrics.run();
    EXPECT_FALSE(run_summary.outcome.success);
    // 30 mm and the slack of 2 mm at 20 mm/s.
    EXPECT_EQ(run_summary.outcome.reason, "the tube went into the oesophagus at 1.6 s");
    EXPECT_EQ(run.metrics.live().tube_place, TubePlace::oesophagus);
    EXPECT_EQ(run_summary.metrics.oesophageal_entries, 1);
    EXPECT_EQ(run_summary.metrics.cormack_lehane_grade, 2);
}

TEST(Metrics, FailuresNameTheirCause) {
    const test::Path path = test::tracheal_path();
    const float glottis = path.length_to(2);
    const auto outcome_of = [&](float tip, float opening, double seconds = 2.0) {
        Session run;
        run.play(seconds, [&](double t, scene::Snapshot& s, GlotticView& view) {
            place_blade(s, run.scope, 0.03f);
            view.opening_percent = opening;
            s.tube_nodes = test::tube_on(path, std::min(tip, glottis - 0.2f + 0.3f * static_cast<float>(t)));
        });
        run.metrics.finish();
        return run.metrics.run().outcome;
    };
    EXPECT_EQ(outcome_of(glottis - 0.2f, 2.0f).reason, "the glottis was never seen (best view 2 %)");
    EXPECT_EQ(outcome_of(glottis - 0.2f, 63.0f).reason, "the tube never entered the mouth (best view 63 %)");
    EXPECT_EQ(outcome_of(glottis - 0.012f, 63.0f).reason,
              "the tube's tip came no nearer than 12 mm to the glottis (best view 63 %)");
    EXPECT_EQ(outcome_of(glottis + 0.004f, 63.0f).reason,
              "the tube's tip lies only 4 mm past the glottis, and 10 mm are required");
    EXPECT_EQ(outcome_of(glottis + 0.056f, 63.0f).reason,
              "the tube's tip lies 6 mm past the carina, in a main bronchus");
    EXPECT_FALSE(outcome_of(glottis + 0.056f, 63.0f).success);
    const Outcome late = outcome_of(glottis + 0.02f, 63.0f, 31.0);
    EXPECT_TRUE(late.success);
    EXPECT_EQ(late.reason,
              "the tube's tip lies 20 mm past the glottis, 30 mm above the carina; it took 31.0 s, over the "
              "limit of "
              "30 s");
    Session idle;
    idle.play(1.0, [](double, scene::Snapshot&, GlotticView&) {});
    idle.metrics.finish();
    EXPECT_EQ(idle.metrics.run().outcome.reason, "the blade never entered the mouth");
}

TEST(Metrics, RunCombinesAttempts) {
    RunPart a, b;
    a.metrics.gum_force_max_n = 4;
    a.metrics.gum_force_mean_n = 1;
    a.metrics.time_s = 10;
    a.metrics.pitch_peaks = 3;
    a.metrics.attempts = 1;
    a.metrics.cormack_lehane_grade = 3;
    a.metrics.glottic_opening_max_percent = 90;
    a.metrics.head_elevation_deg = 4;
    a.metrics.tube_speed_max_cm_per_s = std::nan("");
    a.metrics.tube_speed_mean_cm_per_s = std::nan("");
    a.weights = {10, 0, 0};
    b = a;
    b.metrics.gum_force_max_n = 2;
    b.metrics.gum_force_mean_n = 2;
    b.metrics.time_s = 30;
    b.metrics.pitch_peaks = 1;
    b.metrics.cormack_lehane_grade = 2;
    b.metrics.glottic_opening_max_percent = 50;
    b.metrics.head_elevation_deg = 9;
    b.metrics.tube_speed_max_cm_per_s = 5;
    b.metrics.tube_speed_mean_cm_per_s = 3;
    a.metrics.time_to_first_view_s = std::nan("");
    b.metrics.time_to_first_view_s = 7;
    b.weights = {30, 4, 6};
    b.passed_glottis = true;
    const std::array<RunPart, 2> parts = {a, b};
    const AttemptMetrics run = combine(parts);
    EXPECT_EQ(run.gum_force_max_n, 4);
    EXPECT_NEAR(run.gum_force_mean_n, (1.0 * 10 + 2.0 * 30) / 40, 1e-12);
    EXPECT_EQ(run.time_s, 40);
    EXPECT_EQ(run.pitch_peaks, 4);
    EXPECT_EQ(run.attempts, 2);
    EXPECT_EQ(run.cormack_lehane_grade, 2);
    EXPECT_EQ(run.time_to_first_view_s, 7) << "the only attempt with a view";
    EXPECT_EQ(run.head_elevation_deg, 9);
    EXPECT_EQ(run.tube_speed_max_cm_per_s, 5);
    EXPECT_EQ(run.tube_speed_mean_cm_per_s, 3);
}

TEST(Metrics, OldSnapshotsAreIgnored) {
    Session run;
    run.play(2.0, [&](double, scene::Snapshot& s, GlotticView&) { place_blade(s, run.scope, 0.03f); });
    const double time = run.metrics.current_metrics().time_s;
    run.snapshot.time_ns -= 1'000'000'000;
    run.metrics.observe(run.snapshot, run.view);
    EXPECT_EQ(run.metrics.current_metrics().time_s, time);
}

}  // namespace
}  // namespace eti::metrics
