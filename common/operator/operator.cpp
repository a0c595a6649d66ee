// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/operator.hpp"

#include "common/math/units.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti {

namespace {

constexpr Range offset_range{-200, 200, millimetre};

Landmark landmark(YamlMap& map, const std::string& key, Landmark fallback) {
    return static_cast<Landmark>(map.choice(key, static_cast<std::size_t>(fallback), landmark_names));
}

Stage read_stage(YamlMap& map, bool first, Tool tool) {
    Stage s;
    s.name = map.name("stage", "");
    if (s.name.empty()) {
        map.refuse("stage", "nothing", "a name for the stage");
    }
    s.keep = map.flag("keep", s.keep);
    s.follow = map.flag("follow", s.follow);
    s.steer = map.flag("steer", s.steer);
    if (s.steer && tool != Tool::tube) {
        map.refuse("steer", "'on' for the laryngoscope", "it only under 'tube'; the tube's tip is steered");
    }
    if (s.keep && first) {
        map.refuse("keep", "'on' in a track's first stage",
                   "an earlier stage to keep; give 'tip' and 'axis'");
    }
    for (const char* key : {"tip", "axis", "follow", "steer"}) {
        if (s.keep && map.has(key)) {
            map.refuse(key, "a value together with 'keep: on'",
                       "one of the two; a kept pose already has its tip and axis");
        }
    }
    if (auto tip = map.map("tip")) {
        s.tip_at = landmark(*tip, "at", s.tip_at);
        s.tip_offset = tip->vector("offset_mm", offset_range);
        s.tip_fixed_offset = tip->vector("fixed_offset_mm", offset_range);
        tip->finish();
    }
    if (auto axis = map.map("axis")) {
        s.axis_from = landmark(*axis, "from", s.axis_from);
        s.axis_from_offset = axis->vector("from_offset_mm", offset_range);
        s.axis_from_fixed_offset = axis->vector("from_fixed_offset_mm", offset_range);
        s.axis_to_tip = !axis->has("to");
        s.axis_to = landmark(*axis, "to", s.axis_to);
        if (!s.axis_to_tip && s.axis_to == s.axis_from && s.axis_from_offset.isZero() &&
            s.axis_from_fixed_offset.isZero()) {
            axis->refuse("to", "the place of 'from'",
                         "a different place; identical places define no direction");
        }
        axis->finish();
    }
    s.lift = map.number("lift_mm", s.lift, {-60, 60, millimetre});
    s.advance = map.number("advance_mm", s.advance, {-200, 200, millimetre});
    s.withdraw = map.number("withdraw_mm", s.withdraw, {0, 200, millimetre});
    s.depth_at_lip = map.number("depth_at_lip_mm", s.depth_at_lip, {0, 200, millimetre});
    s.depth_by_rule = map.flag("depth_by_rule", s.depth_by_rule);
    if (s.depth_by_rule && map.has("depth_at_lip_mm")) {
        map.refuse("depth_by_rule", "'on' together with 'depth_at_lip_mm'",
                   "one of the two; remove the other");
    }
    s.pitch = map.number("pitch_deg", s.pitch, {-60, 60, degree});
    s.yaw = map.number("yaw_deg", s.yaw, {-60, 60, degree});
    s.roll = map.number("roll_deg", s.roll, {-180, 180, degree});
    if (map.has("pivot")) {
        s.pivot_at_tip = false;
    }
    s.pivot = landmark(map, "pivot", s.pivot);
    s.speed = map.number("speed_mm_per_s", s.speed, {1, 1000, millimetre});
    s.hold = map.number("hold_s", s.hold, {0, 120});
    if (auto until = map.map("until")) {
        s.until_view_percent = until->number("view_percent", s.until_view_percent, {0, 100});
        s.until_tube_depth = until->number("tube_depth_mm", s.until_tube_depth, {0, 200, millimetre});
        s.until_tube_aside = until->number("tube_aside_mm", s.until_tube_aside, {0, 50, millimetre});
        s.until_blade_past = until->number("blade_past_mm", s.until_blade_past, {0, 50, millimetre});
        s.until_time = until->number("time_s", s.until_time, {0, 3600});
        until->finish();
    }
    if (s.until_tube_aside >= 0.0f && !s.steer) {
        map.refuse("until", "'tube_aside_mm' in a stage that does not steer",
                   "'steer: on' in the same stage");
    }
    if (s.until_blade_past >= 0.0f && (tool == Tool::tube || s.keep)) {
        map.refuse("until", "'blade_past_mm' in a stage that does not move the blade to a landmark",
                   "it in a stage of the laryngoscope with a 'tip'");
    }
    s.timeout = map.number("timeout_s", s.timeout, {0, 600});
    s.abort_on_timeout = map.flag("abort_on_timeout", s.abort_on_timeout);
    map.finish();
    return s;
}

Track read_track(YamlMap& root, Tool tool) {
    Track track;
    for (YamlMap& stage : root.list(tool == Tool::tube ? "tube" : "laryngoscope")) {
        track.stages.push_back(read_stage(stage, track.stages.empty(), tool));
    }
    return track;
}

Variation read_variation(YamlMap& map) {
    Variation v;
    v.tremor = map.number("tremor_mm", v.tremor, {0, 5, millimetre});
    v.reaction = map.number("reaction_s", v.reaction, {0, 5});
    v.path = map.number("path_mm", v.path, {0, 30, millimetre});
    v.speed = map.number("speed", v.speed, {0, 2});
    v.pause = map.number("pause_s", v.pause, {0, 10});
    v.lift = map.number("lift", v.lift, {0, 1});
    v.lever = map.number("lever_deg", v.lever, {0, 45, degree});
    v.view = map.number("view", v.view, {0, 1});
    v.steering = map.number("steering", v.steering, {0, 1});
    v.depth = map.number("depth_mm", v.depth, {0, 50, millimetre});
    map.finish();
    return v;
}

}  // namespace

OperatorScript load_operator(const std::filesystem::path& file) {
    return parse_operator(read_text_file(file), file);
}

OperatorScript parse_operator(const std::string& text, const std::filesystem::path& file) {
    YamlMap root = YamlMap::parse(text, file.string());
    OperatorScript script;
    script.name = root.name("name", file.stem().string());
    script.description = root.text("description", "");
    script.tremor = root.number("tremor_mm", script.tremor, {0, 5, millimetre});
    script.reaction = root.number("reaction_s", script.reaction, {0, 5});
    script.seed = root.seed("seed", script.seed);
    script.laryngoscope = read_track(root, Tool::laryngoscope);
    script.tube = read_track(root, Tool::tube);
    script.laryngoscope.weight = script.tube.weight = root.number("patient_weight_kg", 0.0f, {0.5f, 4.5f});
    script.laryngoscope.lean = root.number("lean_mm", 0.0f, {0, 20, millimetre});
    script.skill = root.number("skill", script.skill, {0, 1});
    script.attempts = root.whole("attempts", script.attempts, 1, max_attempts);
    if (auto variation = root.map("variation")) {
        script.variation = read_variation(*variation);
    }
    root.finish();
    if (script.laryngoscope.stages.empty() && script.tube.stages.empty()) {
        root.refuse("laryngoscope", "no stages for either hand",
                    "at least one stage under 'laryngoscope' or 'tube'");
    }
    return script;
}

}  // namespace eti
