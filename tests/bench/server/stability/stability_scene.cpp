// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The patient's head and jaw moved through their whole range in one step, and at the scenes' own rate.
#include "common/math/units.hpp"
#include "common/model/pace.hpp"
#include "common/model/runtime_parameters.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::bench {

namespace {

constexpr double scene_watched = 6.0;  // [s]; a scene takes 3.5 s, and the shell's distances follow after one
constexpr float at_once = 1e6f;        // [rad/s]
constexpr double scene_size = 10e-3;   // [m], what 1 % refers to

/// [rad/s], rate of head and jaw in a scene.
float scene_rate() {
    return find_runtime_parameter("jaw_opening")->rate;
}

struct Move {
    std::string name;
    patient::Posture from, to;
    float rate = at_once;  ///< [rad/s]
};

scene::Inputs parked_inputs(const patient::Posture& posture) {
    scene::Inputs inputs;
    inputs.laryngoscope.translation = Vec3f(0.0f, -0.25f, 0.15f);
    inputs.tube_grip.translation = Vec3f(-0.12f, -0.25f, 0.10f);
    inputs.runtime_parameters.head_elevation = posture.head_elevation;
    inputs.runtime_parameters.jaw_opening = posture.jaw_opening;
    return inputs;
}

/// The patient at rest in a posture, without motion.
std::vector<FramePose> settled_frames(const patient::Patient& patient, const Laryngoscope& scope,
                                      const patient::Posture& posture, const scene::Settings& settings) {
    scene::Scene scene(patient, scope, Tube{}, parked_inputs(posture), settings);
    for (int k = 0; k < static_cast<int>(scene_watched) * steps_per_second; ++k) {
        scene.step(parked_inputs(posture));
    }
    return scene.snapshot().frames;
}

/// Compares the frames of bones and clusters with those of a patient built in the posture.
RecoveryResult move(const patient::Patient& patient, const Move& move, int substeps) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    scene::Settings settings;
    settings.substeps = substeps;
    const std::vector<FramePose> expected = settled_frames(patient, scope, move.to, settings);
    settings.rate_scale = move.rate / scene_rate();
    scene::Scene scene(patient, scope, Tube{}, parked_inputs(move.from), settings);
    RecoveryTracker tracker(scene_size, scene_watched);
    double thrown = 0.0;
    for (int k = 0; k <= static_cast<int>(scene_watched) * steps_per_second; ++k) {
        double away = 0.0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const FramePose& frame = scene.snapshot().frames[i];
            const double d = static_cast<double>((frame.centre - expected[i].centre).norm());
            away = std::isfinite(d) ? std::max(away, d) : std::numeric_limits<double>::infinity();
            tracker.observe(frame.rotation);
        }
        thrown = k == 0 ? away : thrown;
        tracker.observe(static_cast<double>(k) / steps_per_second, away, 0.0);
        scene.step(parked_inputs(move.to));
    }
    return tracker.result(thrown);
}

}  // namespace

void head_in_one_step(const Sweep& sweep, StabilityTable& maps) {
    const patient::Posture rest{}, head{max_head_elevation, 0.0f}, jaw{0.0f, max_jaw_opening},
        both{max_head_elevation, max_jaw_opening};
    const std::vector<Move> moves = {{"head 0 to 30 deg", rest, head},
                                     {"head 30 to 0 deg", head, rest},
                                     {"jaw 0 to 35 deg", rest, jaw},
                                     {"jaw, at 100 deg/s", rest, jaw, 100.0f * degree},
                                     {"jaw, as fast as a scene", rest, jaw, scene_rate()},
                                     {"head and jaw, there", rest, both},
                                     {"head and jaw, back", both, rest},
                                     {"both, as fast as a scene", rest, both, scene_rate()}};
    const int shipped = Scenario::Physics{}.substeps;
    for (const Move& m : moves) {
        if (sweep.quick && m.name != "both, as fast as a scene") {
            continue;
        }
        for (const int substeps : sweep.quick ? std::vector{shipped} : std::vector{1, 2, 4, shipped, 16}) {
            maps.add("scene", "head in one step", "coarse patient", m.name,
                     step_name(steps_per_second * substeps),
                     [&] { return move(test::coarse_newborn(), m, substeps); });
        }
    }
    if (!sweep.quick) {
        const patient::Patient shipped_model = patient::build_patient(NewbornShape{}, {});
        for (const Move& m : moves) {
            maps.add("scene", "head in one step", "shipped patient", m.name,
                     step_name(steps_per_second * shipped), [&] { return move(shipped_model, m, shipped); });
        }
    }
}

}  // namespace eti::bench
