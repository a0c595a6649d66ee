// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/runtime_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/posture_range.hpp"

namespace eti {

namespace {

constexpr float posture_rate = 0.17f;  // [rad/s]; a head is tilted at about 10 deg/s
constexpr float pressure_rate = 5.0f;  // [N/s]; fingers reach their force within a second or two
// [N]. 10.5 N on the cricoid halved the airway's calibre in children on average, 5 N in infants (Walker 2010,
// Br J Anaesth 104:71, doi 10.1093/bja/aep337).
constexpr float max_laryngeal_pressure = 10.0f;
constexpr float max_pressure_aside = 5.0f;  // [N], chosen
constexpr float immediate = 0.0f;

// Elements of the enhanced view, each switchable on its own.
constexpr RuntimeParameterField aid(std::string_view name, std::string_view label,
                                    float RuntimeParameters::*value, std::string_view help) {
    return {{name, "view", label, "", 1.0f, 0.0f, 1.0f, value, help}, immediate, false, "inputs", "1", true};
}

/// One direction of an assistant's pressure on the larynx.
constexpr RuntimeParameterField pressure(std::string_view name, std::string_view label, float low, float high,
                                         float RuntimeParameters::*value, std::string_view help) {
    return {
        {name, "assistant", label, "N", 1.0f, low, high, value, help}, pressure_rate, false, "skeleton", "N"};
}

constexpr RuntimeParameterField runtime_parameter_rows[] = {
    {{"head_elevation", "patient", "head elevation", "deg", degree, 0.0f, max_head_elevation_deg,
      &RuntimeParameters::head_elevation,
      "Rotation of the skull about the upper neck, positive chin-up; aligns mouth and throat"},
     posture_rate,
     false,
     "skeleton",
     "rad"},
    {{"jaw_opening", "patient", "jaw opening", "deg", degree, 0.0f, max_jaw_opening_deg,
      &RuntimeParameters::jaw_opening,
      "Rotation of the mandible about its joints; no blade enters a closed jaw"},
     posture_rate,
     false,
     "skeleton",
     "rad"},
    {{"table_angle", "patient", "table angle", "deg", degree, -max_table_angle_deg, max_table_angle_deg,
      &RuntimeParameters::table_angle,
      "Tilt of the operating table, positive head-up. The patient frame tilts with it, so that the direction "
      "of gravity on saliva, tube and tissue changes"},
     posture_rate,
     false,
     "skeleton",
     "rad"},
    {{"muscle_tone", "patient", "muscle tone", "", 1.0f, 0.0f, 1.0f, &RuntimeParameters::muscle_tone,
      "Tone of the muscles at neck, jaw and hyoid: 0 relaxed, as with neuromuscular block, 1 awake, with "
      "three "
      "times the passive stiffness. Requires bones that yield"},
     0.5f,
     false,
     "skeleton",
     "1"},
    pressure(
        "laryngeal_pressure_back", "larynx pressed back", 0.0f, max_laryngeal_pressure,
        &RuntimeParameters::laryngeal_pressure_back,
        "External pressure of an assistant's fingers on the thyroid cartilage, posterior. From 5 N on an "
        "infant's airway is distorted. Requires bones that yield"),
    pressure("laryngeal_pressure_up", "larynx pressed up", -max_pressure_aside, max_pressure_aside,
             &RuntimeParameters::laryngeal_pressure_up,
             "Pressure of an assistant's fingers on the thyroid cartilage, superior (towards the head); "
             "negative inferior"),
    pressure(
        "laryngeal_pressure_right", "larynx pressed right", -max_pressure_aside, max_pressure_aside,
        &RuntimeParameters::laryngeal_pressure_right,
        "Pressure of an assistant's fingers on the thyroid cartilage, to the patient's right; negative left"),
    {{"head_scale", "", "head scale", "", 1.0f, head_scale_range.low, head_scale_range.high,
      &RuntimeParameters::head_scale,
      "Scale of the cranium, 1 is normal for weight and age; visible in skin and skull only, nothing else "
      "changes"},
     0.1f,
     false,
     "skeleton",
     "1"},
    {{"tongue_scale", "", "tongue scale", "", 1.0f, tongue_scale_range.low, tongue_scale_range.high,
      &RuntimeParameters::tongue_scale, "Scale of the tongue, 1 is normal; 0.55 to 1.5 times the built size"},
     0.1f,
     false,
     "tissue",
     "1"},
    {{"tissue_stiffness", "patient", "tissue stiffness", "kPa", 1e3f, 1.0f, 100.0f,
      &RuntimeParameters::tissue_stiffness,
      "Young's modulus of tongue and mucosa; stiffer tissue is harder to displace"},
     1.0f,
     true,
     "tissue",
     "Pa"},
    // Above ten times the normal flow (5 ml a minute in a term newborn), particles are emitted faster than
    // the ducts release them.
    {{"secretion", "", "secretion", "", 1.0f, 0.0f, 10.0f, &RuntimeParameters::secretion,
      "Secretion rate; 1 is normal, half a millilitre per minute in a term newborn. Requires saliva on or "
      "standby"},
     5.0f,
     false,
     "tissue",
     "1"},
    {{"suction", "", "suction", "", 1.0f, 0.0f, 1.0f, &RuntimeParameters::suction,
      "Suction at the laryngoscope"},
     immediate,
     false,
     "inputs",
     "1"},
    {{"view_enhanced", "view", "enhanced view", "", 1.0f, 0.0f, 1.0f, &RuntimeParameters::view_enhanced,
      "All clients show the mid-sagittal section beside the scene, and all aids below"},
     immediate,
     false,
     "inputs",
     "1",
     true},
    aid("view_gum_force", "mark of the gum force", &RuntimeParameters::view_gum_force,
        "The force on the upper gum, shown at its position by a colour and a number"),
    aid("view_sight_line", "laser dot", &RuntimeParameters::view_sight_line,
        "A dot where the line of sight to the glottis ends, with the name of the structure; in a section the "
        "whole line"),
    aid("view_glottis", "tinted glottis", &RuntimeParameters::view_glottis,
        "Tints the visible part of the glottic opening"),
    aid("view_axes", "axes of the airway", &RuntimeParameters::view_axes,
        "Axes of mouth, throat and larynx, and the angles between them"),
    aid("view_clock", "clock of the attempt", &RuntimeParameters::view_clock,
        "Duration of the attempt and its limit, red when exceeded"),
    aid("view_tube_depth", "tube depth against the rule", &RuntimeParameters::view_tube_depth,
        "Depth of the tube at the lip, and the value of the rule weight plus 6 cm"),
    aid("view_warnings", "warnings", &RuntimeParameters::view_warnings,
        "A warning while the gum force is high, or the tube is in the oesophagus, too deep or in a main "
        "bronchus"),
    {{"tube_youngs_modulus", "tube", "tube stiffness", "MPa", 1e6f, 1.0f, 200.0f,
      &RuntimeParameters::tube_youngs_modulus,
      "Young's modulus of the tube's material; 10 to 20 is PVC, higher values represent a stylet"},
     1.0f,
     true,
     "tools",
     "Pa"},
    {{"tube_curve_radius", "tube", "tube curve", "mm", millimetre, 60.0f, 2000.0f,
      &RuntimeParameters::tube_curve_radius, "Radius of the tube's manufactured curve; 2000 is straight"},
     1.0f,
     true,
     "tools",
     "m"},
};

/// `from` moved towards `to` by at most `most`.
float approach(float from, float to, float most) {
    return std::abs(to - from) <= most ? to : from + std::clamp(to - from, -most, most);
}

}  // namespace

constinit const std::span<const RuntimeParameterField> runtime_parameter_fields = runtime_parameter_rows;

const RuntimeParameterField* find_runtime_parameter(std::string_view name) {
    const auto found = std::ranges::find(runtime_parameter_fields, name, &RuntimeParameterField::name);
    return found == runtime_parameter_fields.end() ? nullptr : &*found;
}

bool acts_on_yielding_bones(const RuntimeParameterField& field) {
    return field.value == &RuntimeParameters::muscle_tone || field.section == "assistant";
}

RuntimeParameters advance_towards(const RuntimeParameters& from, const RuntimeParameters& to, float seconds,
                                  float rate_scale) {
    RuntimeParameters out = to;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        if (field.rate > 0.0f) {
            const float now = from.*field.value;
            const float most = rate_scale * field.rate * seconds * (field.relative ? now : 1.0f);
            out.*field.value = approach(now, to.*field.value, most);
        }
    }
    return out;
}

Tube apply_to_tube(Tube tube, const RuntimeParameters& values) {
    tube.youngs_modulus = values.tube_youngs_modulus;
    tube.curve_radius = values.tube_curve_radius;
    return tube;
}

RuntimeParameters clamped(const RuntimeParameters& values) {
    RuntimeParameters out = values;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        out.*field.value = field.clamped(values.*field.value);
    }
    return out;
}

}  // namespace eti
