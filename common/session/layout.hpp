// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/hdf5/group.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/session/record.hpp"

// Maps fields of records to data sets. Writer and reader both iterate over these lists, so a field is added
// in one place. `column(path, label, field, width)` is called once per data set; `field(record)` returns a
// reference to the field; for `width` see Cell.

namespace eti::session {

inline constexpr std::string_view file_kind = "NeoETI session";
/// Incremented when a reader of the older layout would misread the newer one; added data sets need no
/// increment.
inline constexpr std::uint64_t schema = 1;

inline constexpr std::size_t kind_bytes = 32;
inline constexpr std::size_t sender_bytes = 48;
inline constexpr std::size_t text_bytes = 256;
inline constexpr std::size_t hash_bytes = 16;

// Rows per chunk: half a second of steps. Full chunks are written to their series at once; until then the
// rows are in the tail (tail.hpp), each half of which holds more than a chunk of each. A chunk of more than
// one page of the file starts on its own page: with chunks of 1024 frames, pages took half as much again as
// their contents.
inline constexpr std::size_t step_chunk = 90;
inline constexpr std::size_t moved_frame_chunk = 4096;
inline constexpr std::size_t fluid_chunk = 8192;
inline constexpr std::size_t small_chunk = 16;

/// Groups of the step series; each links to the common time axis as `time_ns`.
inline constexpr std::string_view step_groups[] = {"inputs",   "tools",  "contacts",
                                                   "skeleton", "tissue", "metrics"};

/// "gum_force_n.max" -> "gum_force_n/max".
[[nodiscard]] inline std::string path_of(const MetricField& field) {
    std::string path(field.key);
    for (char& c : path) {
        c = c == '.' ? '/' : c;
    }
    return path;
}

template <class Column>
void metric_columns(const std::string& group, const Column& column) {
    for (const MetricField& field : metric_fields) {
        const std::string description(field.label);
        column(
            group + "/" + path_of(field), hdf5::Label{field.unit.empty() ? "1" : field.unit, description},
            [value = field.value](auto& record) -> auto& { return record.metrics.*value; }, 0);
    }
}

/// Arguments of the column lists: path, units, description, the field of a row as a pointer to it or a
/// function, and its width where the type does not give it. `column` must outlive it.
template <class Column>
auto column_adder(const Column& column) {
    return [&column](const char* path, const char* units, const char* description, auto field,
                     std::size_t width = 0) {
        column(
            path,
            hdf5::Label{units, description}, [field](auto& row) -> auto& { return std::invoke(field, row); },
            width);
    };
}

/// `tube_nodes`: number of points of the tube's centre line.
inline constexpr auto step_columns = [](std::size_t tube_nodes) {
    return [tube_nodes](const auto& column) {
        const auto add = column_adder(column);
        add("inputs/time_ns", "ns",
            "simulation time since the session began; the row's step in all step series",
            &StepRecord::time_ns);
        add("inputs/step", "1", "number of the simulation step", &StepRecord::step);
        add("inputs/laryngoscope_pose", "m, 1",
            "laryngoscope held by the hand, as latched: position x y z, unit quaternion w x y z, patient "
            "frame",
            &StepRecord::laryngoscope);
        add("inputs/tube_grip_pose", "m, 1",
            "grip of the tube, as latched: position x y z, unit quaternion w x y z, patient frame",
            &StepRecord::tube_grip);
        add("inputs/eye_pose", "m, 1",
            "eye of the trainee, as latched: position x y z, unit quaternion w x y z, patient frame; NaN "
            "before the first one",
            &StepRecord::eye);

        add("tools/proxy_pose", "m, 1",
            "laryngoscope as constrained by the shell: position x y z, unit quaternion w x y z, patient "
            "frame",
            &StepRecord::proxy);
        add("tools/shell_force", "N", "force of the shell on the laryngoscope, patient frame",
            &StepRecord::shell_force);
        add("tools/shell_torque", "N m", "torque of the shell on the laryngoscope about its origin",
            &StepRecord::shell_torque);
        add("tools/tissue_force", "N", "force of the soft tissue on the blade, patient frame",
            &StepRecord::tissue_force);
        add("tools/tissue_torque", "N m",
            "torque of the soft tissue on the blade about the laryngoscope's origin",
            &StepRecord::tissue_torque);
        add("tools/tube_nodes", "m",
            "centre line of the tube from connector to tip: step, node, x y z, patient frame",
            &StepRecord::tube_nodes, tube_nodes);

        add(
            "contacts/pressed", "N",
            "sum of the shell's normal forces on the blade, per tissue: soft, tongue, epiglottis, larynx, "
            "trachea, oesophagus, upper gum, lower gum, palate, skull, mandible, spine, hyoid",
            [](auto& r) -> auto& { return r.loads.pressed; });
        add(
            "contacts/net", "N",
            "net force of a tissue's particles on the blade: step, tissue as in pressed, x y z, patient "
            "frame",
            [](auto& r) -> auto& { return r.loads.net; });
        add(
            "contacts/place", "m",
            "contact position on the blade, force-weighted mean: step, tissue as in pressed, x y z, patient "
            "frame; NaN without contact",
            [](auto& r) -> auto& { return r.loads.place; });

        for (const RuntimeParameterField& field : runtime_parameter_fields) {
            column(
                std::string(field.group) + "/" + std::string(field.name), hdf5::Label{field.si, field.help},
                [value = field.value](auto& r) -> auto& { return r.runtime_parameters.*value; },
                std::size_t{0});
        }

        add("skeleton/skull_rotation", "1",
            "rotation of the skull from rest: unit quaternion w x y z, patient frame",
            &StepRecord::skull_rotation);
        add("tissue/landmarks", "m",
            "positions of the landmarks: step, landmark as in scene/landmarks/name, x y z, patient frame",
            &StepRecord::landmarks);

        add("metrics/attempt", "1", "number of the attempt; 0 before the first", &StepRecord::attempt);
        add("metrics/attempt_running", "1", "1 while the blade is in the mouth",
            &StepRecord::attempt_running);
        for (const LiveMeasureField& field : live_measure_fields) {
            column(
                "metrics/" + std::string(field.key),
                hdf5::Label{field.si.empty() ? "1" : field.si, field.help},
                [value = field.value](auto& r) -> auto& { return r.measures.*value; }, std::size_t{0});
        }
        add("metrics/eye_used", "m",
            "eye position of the last view of the glottis, the trainee's or, without an eye_pose, that of "
            "the best view: x y z, patient frame; 30 times a second",
            &StepRecord::eye_used);
        metric_columns("metrics", column);
    };
};

inline constexpr auto command_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("inputs/commands/time_ns", "ns", "simulation time at which the command was latched",
        &CommandRecord::time_ns);
    add("inputs/commands/step", "1", "first step to which it applies", &CommandRecord::step);
    add("inputs/commands/kind", "1", "requested value", &CommandRecord::kind, kind_bytes);
    add("inputs/commands/value", "rad, Pa or 1", "angles in rad, stiffness in Pa, the rest as ratios",
        &CommandRecord::value);
    add("inputs/commands/sender", "1", "sender", &CommandRecord::sender, sender_bytes);
    add("inputs/commands/id", "1", "sequence number chosen by the sender", &CommandRecord::id);
};

inline constexpr auto state_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("state/time_ns", "ns", "simulation time", &StateRecord::time_ns);
    add("state/step", "1", "number of the simulation step", &StateRecord::step);
    add("state/hash", "1",
        "FNV-1a over the bits of positions and velocities of tissue, tube, proxy and liquid after this step; "
        "16 hexadecimal digits",
        &StateRecord::hash, hash_bytes);
};

/// One row per record of the deformation: the range of its rows among the moved frames.
struct MovedFrames {
    std::uint64_t time_ns = 0;
    std::uint64_t first_row = 0;
    std::uint32_t row_count = 0;
};

inline constexpr auto moved_frames_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("deformation/time_ns", "ns", "simulation time", &MovedFrames::time_ns);
    add("deformation/first_row", "1", "first row of this time in frame, rotation and centre",
        &MovedFrames::first_row);
    add("deformation/row_count", "1", "number of rows of this time: the frames that moved since the last",
        &MovedFrames::row_count);
};

/// One frame that moved.
struct MovedFrame {
    std::uint16_t frame = 0;
    FramePose pose;
};

inline constexpr auto moved_frame_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("deformation/frame", "1", "index of the frame in scene/frame_rest_centre", &MovedFrame::frame);
    add(
        "deformation/rotation", "1",
        "unit quaternion w x y z from rest: a rest point x goes to rotation * (x - rest_centre) + centre",
        [](auto& r) -> auto& { return r.pose.rotation; });
    add(
        "deformation/centre", "m", "current position of the frame's rest centre, patient frame",
        [](auto& r) -> auto& { return r.pose.centre; });
};

/// One row per record of the liquid: the range of its rows among the positions.
struct FluidRows {
    std::uint64_t time_ns = 0;
    std::uint64_t first_row = 0;
    std::uint32_t row_count = 0;
};

inline constexpr auto fluid_rows_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("fluid/time_ns", "ns", "simulation time", &FluidRows::time_ns);
    add("fluid/first_row", "1", "first row of this time in position", &FluidRows::first_row);
    add("fluid/row_count", "1", "number of rows of this time: the liquid's particles", &FluidRows::row_count);
};

/// One particle of the liquid.
struct FluidParticle {
    Vec3f position = Vec3f::Zero();
};

inline constexpr auto fluid_columns = [](const auto& column) {
    column_adder(column)("fluid/position", "m", "position of a particle of saliva, patient frame",
                         &FluidParticle::position);
};

inline constexpr auto event_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("events/time_ns", "ns", "simulation time", &EventRecord::time_ns);
    add("events/kind", "1", "one word", &EventRecord::kind, kind_bytes);
    add("events/text", "1", "what happened", &EventRecord::text, text_bytes);
};

/// One row per annotation on a surface: the range of its rows among the places.
struct AnnotationRows {
    std::uint64_t time_ns = 0;
    std::string kind, sender, text, object;
    std::uint64_t first_row = 0;
    std::uint32_t row_count = 0;
};

inline constexpr auto annotation_rows_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("annotations/time_ns", "ns", "simulation time", &AnnotationRows::time_ns);
    add("annotations/kind", "1", "point or stroke", &AnnotationRows::kind, kind_bytes);
    add("annotations/sender", "1", "who", &AnnotationRows::sender, sender_bytes);
    add("annotations/text", "1", "its label", &AnnotationRows::text, text_bytes);
    add("annotations/object", "1", "annotated object: a surface of scene, or laryngoscope",
        &AnnotationRows::object, sender_bytes);
    add("annotations/first_row", "1", "its first row in triangle, place and position",
        &AnnotationRows::first_row);
    add("annotations/row_count", "1", "number of its rows", &AnnotationRows::row_count);
};

/// One place of an annotation.
struct AnnotationPlace {
    std::uint32_t triangle = 0;
    Vec3f place = Vec3f::Zero();
    Vec3f position = Vec3f::Zero();
};

inline constexpr auto annotation_place_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("annotations/triangle", "1", "triangle a b c of the object that carries the position",
        &AnnotationPlace::triangle);
    add("annotations/place", "1, 1, m",
        "u v height: the position is a + u (b - a) + v (c - a) + height along the triangle's normal",
        &AnnotationPlace::place);
    add("annotations/position", "m", "the position at that time, patient frame", &AnnotationPlace::position);
};

inline constexpr auto summary_columns = [](const auto& column) {
    const auto add = column_adder(column);
    add("summary/attempt", "1",
        "number of the attempt, 0 for the whole run; a later row replaces an earlier one",
        &SummaryRecord::attempt);
    add(
        "summary/success", "1", "1 if the trachea was intubated",
        [](auto& r) -> auto& { return r.outcome.success; });
    add(
        "summary/reason", "1", "reason for success or failure",
        [](auto& r) -> auto& { return r.outcome.reason; }, text_bytes);
    add("summary/began", "s", "simulation time at which the attempt began", &SummaryRecord::began);
    add("summary/ended", "s", "simulation time at which it ended", &SummaryRecord::ended);
    metric_columns("summary", column);
};

}  // namespace eti::session
