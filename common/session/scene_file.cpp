// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/scene_file.hpp"

#include <fmt/format.h>
#include <array>

#include <algorithm>

#include "common/hdf5/packing.hpp"
#include "common/session/cell.hpp"
#include "common/session/definitions.hpp"
#include "common/session/layout.hpp"

namespace eti::session {

namespace {

using hdf5::any_extent;
using hdf5::Group;

struct TextField {
    const char* attribute;
    std::string SessionInfo::*value;
};
constexpr const char* blade_length = "blade_length_m";
constexpr const char* weight = "weight_kg";

constexpr TextField text_fields[] = {
    {"session", &SessionInfo::session},        {"start_time", &SessionInfo::start_time},
    {"scenario", &SessionInfo::scenario},      {"scenario_text", &SessionInfo::scenario_text},
    {"operator", &SessionInfo::operator_name}, {"operator_text", &SessionInfo::operator_text},
    {"version", &SessionInfo::version},        {"build", &SessionInfo::build},
};

void write_points(const Group& group, const std::vector<PointRecord>& points, bool named) {
    std::vector<std::string> names;
    std::vector<Vec3f> rest;
    std::vector<SkinWeights> skin;
    for (const PointRecord& point : points) {
        names.push_back(point.name);
        rest.push_back(point.rest);
        skin.push_back(point.skin);
    }
    if (named) {
        group.write_texts("name", names, {"1", "name of each point"});
    }
    write_rows(group, "rest", rest, {"m", "rest position x y z, patient frame"});
    write_skin(group, skin);
}

std::vector<PointRecord> read_points(const Group& group, std::size_t frames, bool named) {
    const auto rest = hdf5::read_rows<Vec3f>(group, "rest");
    require_finite(group, "rest", hdf5::numbers_of(rest));
    const auto skin = read_skin(group, rest.size());
    require_skin(group, skin, frames);
    const std::vector<std::string> names =
        named ? group.read_texts("name") : std::vector<std::string>(rest.size());
    if (names.size() != rest.size()) {
        throw hdf5::Error(
            fmt::format("{}: {} names for {} points", group.at("name"), names.size(), rest.size()));
    }
    std::vector<PointRecord> points;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        points.push_back({names[i], rest[i], skin[i]});
    }
    return points;
}

/// NaN if an older file lacks it.
float number_if_there(const Group& group, const char* attribute) {
    return std::ranges::count(group.attributes(), attribute) > 0 ? static_cast<float>(group.number(attribute))
                                                                 : missing_number;
}

constexpr const char* start_pose = "start_pose";

void write_start(const Group& group, const RigidTransform& pose) {
    std::array<float, 7> numbers{};
    Cell<RigidTransform>::pack(pose, 0, reinterpret_cast<std::byte*>(numbers.data()));
    group.write<float>(
        start_pose, numbers, {numbers.size()},
        {"m, 1",
         "pose of the tool before the first step: position x y z, unit quaternion w x y z, patient frame"});
}

/// Missing in older files.
RigidTransform read_start(const Group& group) {
    if (!group.has(start_pose)) {
        return missing_pose();
    }
    const auto numbers = group.read<float>(start_pose, {7}).values;
    RigidTransform pose;
    Cell<RigidTransform>::unpack(reinterpret_cast<const std::byte*>(numbers.data()), 0, pose);
    return pose;
}

}  // namespace

void write_header(const Group& root, const SessionInfo& info, const SceneRecord& scene,
                  std::uint64_t lost_records) {
    root.set_text("kind", file_kind);
    root.set_integer("schema", schema);
    const Group meta = root.create("meta");
    meta.set_integer("schema", schema);
    meta.set_integer("finished", 0);
    meta.set_integer("lost_records", lost_records);
    write_info(meta, info);
    write_scene(root.create("scene"), scene);
}

void write_info(const Group& meta, const SessionInfo& info) {
    for (const TextField& field : text_fields) {
        meta.set_text(field.attribute, info.*field.value);
    }
    meta.set_integer("seed", info.seed);
    const Group more = meta.create("more");
    for (const auto& [key, value] : info.more) {
        more.set_text(key, value);
    }
}

SessionInfo read_info(const Group& meta) {
    SessionInfo info;
    for (const TextField& field : text_fields) {
        info.*field.value = meta.text(field.attribute);
    }
    info.seed = meta.integer("seed");
    const Group more = meta.open("more");
    for (const std::string& key : more.attributes()) {
        info.more[key] = more.text(key);
    }
    return info;
}

void write_scene(const Group& group, const SceneRecord& scene) {
    group.set_text(
        "patient_frame",
        "+x to the patient's left, +y posterior, +z superior; origin at the midpoint of the upper gum's "
        "crest at rest; it tilts with the table");
    group.set_number(weight, static_cast<double>(scene.weight));
    write_rows(group, "frame_rest_centre", scene.frame_rest_centre,
               {"m", "rest centre of each frame: trunk, skull, mandible, then the clusters; patient frame"});
    const Group surfaces = group.create("surfaces");
    for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
        write_surface(surfaces.create(std::to_string(i)), scene.surfaces[i]);
    }
    write_points(group.create("landmarks"), scene.landmarks, true);
    write_points(group.create("glottis_contour"), scene.glottis_contour, false);
    const Group laryngoscope = group.create("laryngoscope");
    laryngoscope.set_text("blade", scene.blade);
    laryngoscope.set_text("tool_frame",
                          "origin at the junction of blade and handle, +z along the blade to its tip, +y "
                          "along the handle away from the blade, +x = y cross z");
    laryngoscope.set_number(blade_length, static_cast<double>(scene.blade_length));
    write_mesh(laryngoscope, scene.laryngoscope);
    write_start(laryngoscope, scene.laryngoscope_start);
    const Group tube = group.create("tube");
    tube.set_text(
        "tool_frame",
        "origin at the grip on the centre line, +z along the tube to its tip, +y the concave side of its "
        "curve, +x = y cross z");
    tube.set_number("outer_diameter_m", static_cast<double>(scene.tube_outer_diameter));
    tube.set_number("inner_diameter_m", static_cast<double>(scene.tube_inner_diameter));
    tube.set_integer("nodes", scene.tube_nodes);
    write_start(tube, scene.tube_grip_start);
    write_definitions(group, scene.definitions);
}

SceneRecord read_scene(const Group& group) {
    SceneRecord scene;
    scene.weight = number_if_there(group, weight);
    scene.frame_rest_centre = hdf5::read_rows<Vec3f>(group, "frame_rest_centre");
    require_finite(group, "frame_rest_centre", hdf5::numbers_of(scene.frame_rest_centre));
    const std::size_t frames = scene.frame_rest_centre.size();
    const Group surfaces = group.open("surfaces");
    for (std::size_t i = 0; i < surfaces.members().size(); ++i) {
        scene.surfaces.push_back(read_surface(surfaces.open(std::to_string(i)), frames));
    }
    scene.landmarks = read_points(group.open("landmarks"), frames, true);
    scene.glottis_contour = read_points(group.open("glottis_contour"), frames, false);
    const Group laryngoscope = group.open("laryngoscope");
    scene.blade = laryngoscope.text("blade");
    scene.blade_length = number_if_there(laryngoscope, blade_length);
    scene.laryngoscope = read_mesh(laryngoscope);
    scene.laryngoscope_start = read_start(laryngoscope);
    const Group tube = group.open("tube");
    scene.tube_outer_diameter = static_cast<float>(tube.number("outer_diameter_m"));
    scene.tube_inner_diameter = static_cast<float>(tube.number("inner_diameter_m"));
    scene.tube_nodes = tube.integer("nodes");
    scene.tube_grip_start = read_start(tube);
    scene.definitions = read_definitions(group);
    return scene;
}

}  // namespace eti::session
