// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/recorder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/session/definitions.hpp"
#include "common/session/opinions.hpp"
#include "server/metrics/airway_gates.hpp"

namespace eti::app {

namespace {

session::PointRecord point(std::string name, const patient::CarriedPoint& carried) {
    return {std::move(name), carried.rest, carried.skin};
}

session::SceneRecord scene_of(const patient::Patient& patient, const Laryngoscope& scope,
                              const Scenario& scenario, const scene::Snapshot& start) {
    session::SceneRecord scene;
    scene.frame_rest_centre = patient.frame_rest_centre;
    scene.surfaces = patient.surfaces;
    for (std::size_t i = 0; i < landmark_count; ++i) {
        scene.landmarks.push_back(point(std::string(landmark_names[i]), patient.landmarks[i]));
    }
    for (const patient::CarriedPoint& corner : patient.glottis_contour) {
        scene.glottis_contour.push_back(point({}, corner));
    }
    scene.blade = name_of(scope.blade);
    scene.laryngoscope = laryngoscope_mesh(scope);
    scene.blade_length = scope.blade_length;
    scene.tube_outer_diameter = scenario.tube.outer_diameter;
    scene.tube_inner_diameter = scenario.tube.inner_diameter;
    scene.tube_nodes = start.tube_nodes.size();
    scene.laryngoscope_start = start.device;
    scene.tube_grip_start = start.tube_grip;
    scene.liquid = scenario.saliva;
    scene.weight = patient.weight;
    scene.definitions = session::current_definitions(static_cast<double>(scenario.time_limit));
    return scene;
}

session::SessionInfo completed(session::SessionInfo info) {
    if (info.start_time.empty()) {
        info.start_time = session::utc_now();
    }
    if (info.version.empty()) {
        info.version = ETI_VERSION;
    }
    if (info.build.empty()) {
        info.build = build_description();
    }
    return info;
}

session::SessionWriter::Settings writer_settings(bool wait_when_full) {
    session::SessionWriter::Settings settings;
    settings.wait_when_full = wait_when_full;
    settings.on_error = [](const std::string& text) { spdlog::error("{}", text); };
    settings.on_warning = [](const std::string& text) { spdlog::warn("{}", text); };
    return settings;
}

std::array<float, 3> numbers(const Vec3f& v) {
    return {v.x(), v.y(), v.z()};
}

session::TissueLoads loads_of(const scene::Snapshot& snapshot) {
    session::TissueLoads loads;
    std::array<Vec3f, session::touched_tissues> net, moment;
    std::array<float, session::touched_tissues> weight{};
    net.fill(Vec3f::Zero());
    moment.fill(Vec3f::Zero());
    for (const rigid::Contact& contact : snapshot.shell_contacts) {
        const auto tissue = static_cast<std::size_t>(contact.tissue);
        loads.pressed[tissue] += contact.force;
        moment[tissue] += contact.force * contact.position;
        weight[tissue] += contact.force;
    }
    for (const scene::TissueContact& contact : snapshot.tissue_contacts) {
        const auto tissue = static_cast<std::size_t>(contact.tissue);
        const float force = contact.force.norm();
        net[tissue] += contact.force;
        moment[tissue] += force * contact.position;
        weight[tissue] += force;
    }
    for (std::size_t i = 0; i < session::touched_tissues; ++i) {
        loads.net[i] = numbers(net[i]);
        loads.place[i] = numbers(weight[i] > 0.0f ? Vec3f(moment[i] / weight[i])
                                                  : Vec3f(Vec3f::Constant(session::missing_number)));
    }
    return loads;
}

// Frames are quantized to a grid far finer than the threshold of motion: 2^-20 m (1 um), and 2^-15 in the
// quaternion (0.004 deg at most). The low bits of the floats are then zero, and compress.
float quantize(float value, float cells_per_unit) {
    return std::nearbyint(value * cells_per_unit) / cells_per_unit;
}

FramePose quantize(const FramePose& pose) {
    constexpr float shifts = 0x1p20f, turns = 0x1p15f;
    FramePose rounded;
    rounded.centre = pose.centre.unaryExpr([](float v) { return quantize(v, shifts); });
    rounded.rotation.coeffs() = pose.rotation.coeffs().unaryExpr([](float v) { return quantize(v, turns); });
    return rounded;
}

}  // namespace

std::string build_description() {
#if defined(__AVX512F__)
    const char* const instructions = "AVX-512";
#elif defined(__AVX2__)
    const char* const instructions = "AVX2";
#elif defined(__SSE2__)
    const char* const instructions = "SSE2";
#else
    const char* const instructions = "no vector instructions";
#endif
#if defined(NDEBUG)
    const char* const assertions = "without assertions";
#else
    const char* const assertions = "with assertions";
#endif
    return fmt::format("compiler {}, {}, {}, Eigen {}.{}.{}", __VERSION__, instructions, assertions,
                       EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

Recorder::Recorder(const std::filesystem::path& path, session::SessionInfo info,
                   const patient::Patient& patient, const Laryngoscope& scope, const Scenario& scenario,
                   const scene::Snapshot& start, bool wait_when_full)
    : writer_(path, completed(std::move(info)), scene_of(patient, scope, scenario, start),
              writer_settings(wait_when_full)) {}

void fill(session::StepRecord& record, const scene::Snapshot& snapshot, const metrics::LiveMetrics& live,
          const AttemptMetrics& metrics, const std::optional<RigidTransform>& eye, const Vec3f& eye_used) {
    record.time_ns = snapshot.time_ns;
    record.step = snapshot.step;
    record.laryngoscope = snapshot.device;
    record.tube_grip = snapshot.tube_grip;
    record.eye = eye.value_or(session::missing_pose());
    record.proxy = snapshot.proxy;
    record.shell_force = snapshot.shell_force;
    record.shell_torque = snapshot.shell_torque;
    record.tissue_force = snapshot.tissue_force;
    record.tissue_torque = snapshot.tissue_torque;
    record.tube_nodes = snapshot.tube_nodes;
    record.runtime_parameters = snapshot.runtime_parameters;
    record.loads = loads_of(snapshot);
    const Quatf skull = metrics::skull_rotation(snapshot);
    record.skull_rotation = {skull.w(), skull.x(), skull.y(), skull.z()};
    std::ranges::transform(snapshot.landmarks, record.landmarks.begin(), numbers);
    record.attempt = live.attempt;
    record.attempt_running = live.attempt_running;
    record.measures = live.measures;
    record.eye_used = numbers(eye_used);
    record.metrics = metrics;
}

void Recorder::record(const scene::Snapshot& snapshot, const metrics::LiveMetrics& live,
                      const AttemptMetrics& metrics, const std::optional<RigidTransform>& eye,
                      const Vec3f& eye_used) {
    first_ns_ = first_ns_.value_or(snapshot.time_ns);
    fill(step_, snapshot, live, metrics, eye, eye_used);
    writer_.push(step_);
    if (snapshot.time_ns >= next_deformation_ns_) {
        record_deformation(snapshot);
        record_fluid(snapshot);
        next_deformation_ns_ = (snapshot.time_ns / deformation_period_ns + 1) * deformation_period_ns;
    }
}

void Recorder::record_deformation(const scene::Snapshot& snapshot) {
    all_frames_ = all_frames_ || recorded_.size() != snapshot.frames.size();
    recorded_.resize(snapshot.frames.size());
    moved_.time_ns = snapshot.time_ns;
    moved_.frame.clear();
    moved_.pose.clear();
    for (std::size_t i = 0; i < snapshot.frames.size(); ++i) {
        if (all_frames_ || has_moved(recorded_[i], snapshot.frames[i])) {
            moved_.frame.push_back(static_cast<std::uint16_t>(i));
            moved_.pose.push_back(quantize(snapshot.frames[i]));
        }
    }
    // Frames of a lost record are written with the next one.
    if (!moved_.frame.empty() && writer_.push(moved_)) {
        for (std::size_t k = 0; k < moved_.frame.size(); ++k) {
            recorded_[moved_.frame[k]] = moved_.pose[k];
        }
        all_frames_ = false;
    }
}

void Recorder::record_fluid(const scene::Snapshot& snapshot) {
    if (!snapshot.saliva.on) {
        return;
    }
    // Quantized to what drawing tolerates: 15 um.
    fluid_.time_ns = snapshot.time_ns;
    fluid_.position = snapshot.saliva.positions;
    for (Vec3f& p : fluid_.position) {
        p = p.unaryExpr([](float v) { return quantize(v, 0x1p16f); });
    }
    writer_.push(fluid_);
}

void Recorder::command(std::uint64_t time_ns, std::uint64_t step, const std::string& kind, double value,
                       const std::string& sender, std::uint32_t id) {
    writer_.push(session::CommandRecord{time_ns, step, kind, value, sender, id});
}

void Recorder::event(std::uint64_t time_ns, const std::string& kind, const std::string& text) {
    writer_.push(session::EventRecord{time_ns, kind, text});
}

void Recorder::summary(const metrics::AttemptSummary& summary) {
    // A run begins with its first step.
    const double first = static_cast<double>(first_ns_.value_or(0)) * 1e-9;
    writer_.push(session::SummaryRecord{summary.number, summary.outcome, summary.metrics,
                                        first + summary.began, first + summary.ended});
}

}  // namespace eti::app
