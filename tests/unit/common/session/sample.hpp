// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fmt/format.h>
#include <cmath>
#include <string>

#include "common/math/random.hpp"
#include "common/session/record.hpp"

namespace eti::session::sample {

// A synthetic session whose every number is a function of the step's index, so that a reader can verify each
// row.

inline constexpr std::size_t frames = 200;
inline constexpr std::size_t tube_nodes = 17;
inline constexpr std::uint64_t step_ns = 1000000000 / 180;

inline SessionInfo info() {
    SessionInfo info;
    info.session = "sample";
    info.start_time = "2024-02-29T12:00:00Z";
    info.scenario = "term";
    info.scenario_text = "name: term\nweight_kg: 3.5  # µ is two bytes\n";
    info.operator_name = "expert";
    info.operator_text = "name: expert\n";
    info.version = "0.1.0";
    info.build = "test";
    info.seed = 0xfedcba9876543210ULL;
    info.more = {{"threads", "2"}};
    return info;
}

inline SkinWeights skin(Random& random) {
    const float part = random.uniform();
    return {{static_cast<std::uint16_t>(random.bits() % frames), 1, 0, 0}, {part, 1.0f - part, 0.0f, 0.0f}};
}

inline SceneRecord scene(std::size_t vertices = 300) {
    Random random(3);
    SceneRecord scene;
    for (std::size_t i = 0; i < frames; ++i) {
        scene.frame_rest_centre.push_back({random.normal(), random.normal(), random.normal()});
    }
    for (const char* name : {"body", "tongue"}) {
        Surface surface{name, Tissue::tongue, {}, {}, {}};
        for (std::size_t i = 0; i < vertices; ++i) {
            surface.mesh.vertices.push_back({random.normal(), random.normal(), random.normal()});
            surface.skin.push_back(skin(random));
            surface.mesh.triangles.push_back({static_cast<std::uint32_t>(i),
                                              static_cast<std::uint32_t>((i + 1) % vertices),
                                              static_cast<std::uint32_t>((i + 2) % vertices)});
            surface.triangle_tissue.push_back(static_cast<Tissue>(i % tissue_count));
        }
        scene.surfaces.push_back(std::move(surface));
    }
    scene.landmarks = {{"upper_gum", Vec3f::Zero(), skin(random)}, {"carina", Vec3f(0, 1, 2), skin(random)}};
    scene.glottis_contour = {{"", Vec3f(1, 0, 0), skin(random)}, {"", Vec3f(0, 1, 0), skin(random)}};
    scene.liquid = true;
    scene.weight = 3.5f;
    scene.definitions = {7,
                         {{"time_s", "s", "sum", "From its beginning \xe2\x80\x93 to its end", ""},
                          {"attempts", "", "sum", "One", "1"}},
                         {{"gate_slack", 0.002, "m", "so far"}, {"look_rate", 30.0, "1/s", ""}}};
    scene.blade = "miller_1";
    scene.blade_length = 0.125f;
    scene.laryngoscope = scene.surfaces[0].mesh;
    scene.tube_outer_diameter = 4.2e-3f;
    scene.tube_inner_diameter = 3.0e-3f;
    scene.tube_nodes = tube_nodes;
    return scene;
}

/// A smooth value of the step, different for each `channel`; it compresses about as motion does.
inline float value(std::uint64_t step, int channel) {
    return 0.1f * std::sin(0.01f * static_cast<float>(step % 100000) + static_cast<float>(channel));
}

inline Vec3f vector(std::uint64_t step, int channel) {
    return {value(step, channel), value(step, channel + 1), value(step, channel + 2)};
}

inline RigidTransform pose(std::uint64_t step, int channel) {
    return {quaternion_from(vector(step, channel + 3)), vector(step, channel)};
}

inline StepRecord step(std::uint64_t number) {
    StepRecord record;
    record.time_ns = number * step_ns;
    record.step = number;
    record.laryngoscope = pose(number, 0);
    record.tube_grip = pose(number, 10);
    record.eye = pose(number, 20);
    record.runtime_parameters.suction = value(number, 26);
    record.proxy = pose(number, 30);
    record.shell_force = vector(number, 40);
    record.shell_torque = vector(number, 43);
    record.tissue_force = vector(number, 46);
    record.tissue_torque = vector(number, 49);
    for (std::size_t i = 0; i < tube_nodes; ++i) {
        record.tube_nodes.push_back(vector(number, 60 + 3 * static_cast<int>(i)));
    }
    record.runtime_parameters.head_elevation = value(number, 120);
    record.runtime_parameters.jaw_opening = value(number, 121);
    record.runtime_parameters.table_angle = value(number, 125);
    record.runtime_parameters.head_scale = value(number, 129);
    record.runtime_parameters.tongue_scale = value(number, 126);
    record.runtime_parameters.tissue_stiffness = value(number, 127);
    record.runtime_parameters.secretion = value(number, 128);
    record.skull_rotation = {value(number, 310), value(number, 311), value(number, 312), value(number, 313)};
    for (std::size_t i = 0; i < landmark_count; ++i) {
        const int channel = 320 + 3 * static_cast<int>(i);
        record.landmarks[i] = {value(number, channel), value(number, channel + 1),
                               value(number, channel + 2)};
    }
    record.loads.pressed.fill(value(number, 300));
    record.loads.net[6] = {value(number, 301), value(number, 302), value(number, 303)};
    record.loads.place[6] = {value(number, 304), value(number, 305), value(number, 306)};
    record.eye_used = {value(number, 307), value(number, 308), value(number, 309)};
    record.attempt = static_cast<std::uint32_t>(number / 1000);
    record.attempt_running = number % 2 == 1;
    int channel = 400;
    for (const LiveMeasureField& field : live_measure_fields) {
        record.measures.*field.value = value(number, channel++);
    }
    channel = 130;
    for (const MetricField& field : metric_fields) {
        record.metrics.*field.value = static_cast<double>(value(number, channel++));
    }
    return record;
}

inline StateRecord state(std::uint64_t number) {
    return {number * step_ns, number, fmt::format("{:016x}", number)};
}

/// The deformation at a step: a third of the frames has moved.
inline DeformationRecord deformation(std::uint64_t number) {
    DeformationRecord record;
    record.time_ns = number * step_ns;
    for (std::uint16_t i = static_cast<std::uint16_t>(number % 3); i < frames;
         i = static_cast<std::uint16_t>(i + 3)) {
        record.frame.push_back(i);
        const RigidTransform at = pose(number, i);
        record.pose.push_back({at.translation, at.rotation});
    }
    return record;
}

/// The liquid at a step: none at first, then increasing.
inline FluidRecord fluid(std::uint64_t number) {
    FluidRecord record{number * step_ns, {}};
    for (std::uint64_t i = 0; i < number / 2; ++i) {
        record.position.push_back(pose(number, static_cast<std::uint16_t>(i)).translation);
    }
    return record;
}

/// A point, or a stroke of up to five positions.
inline AnnotationRecord annotation(std::uint64_t number) {
    AnnotationRecord record{number * step_ns, "stroke", "desk:7", "at " + std::to_string(number),
                            "tongue",         {},       {}};
    for (std::uint64_t i = 0; i <= number / 100 % 5; ++i) {
        record.place.push_back({static_cast<std::uint32_t>(number + i), value(number, 200),
                                value(number, 201), value(number, 202)});
        record.position.push_back(vector(number + i, 203));
    }
    return record;
}

inline EventRecord event(std::uint64_t number) {
    return {number * step_ns, "attempt", "event of step " + std::to_string(number)};
}

}  // namespace eti::session::sample
