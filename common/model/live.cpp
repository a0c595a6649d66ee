// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/live.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

#include "common/math/units.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/posture_range.hpp"

namespace eti {

namespace {

constexpr float nurse = 0.17f;  // [rad/s]; a head is tilted at about 10 deg/s

/// `from` carried towards `to` by `most` at most.
float approach(float from, float to, float most) {
    return std::abs(to - from) <= most ? to : from + std::clamp(to - from, -most, most);
}

}  // namespace

const std::array<LiveField, 8> live_fields = {{
    {"head_elevation", "patient", "head elevation", "deg", degree, 0.0f, max_head_elevation_deg,
     &LiveValues::head_elevation, nurse, false, "skeleton", "rad",
     "turn of the skull about the upper neck, positive chin-up"},
    {"jaw_opening", "patient", "jaw opening", "deg", degree, 0.0f, max_jaw_opening_deg,
     &LiveValues::jaw_opening, nurse, false, "skeleton", "rad", "turn of the mandible about its joints"},
    {"table_angle", "patient", "table angle", "deg", degree, -max_table_angle_deg, max_table_angle_deg,
     &LiveValues::table_angle, nurse, false, "skeleton", "rad",
     "tilt of the operating table, positive head-up; the patient frame tilts with it"},
    {"head_scale", "", "head scale", "", 1.0f, head_scale_range.low, head_scale_range.high,
     &LiveValues::head_scale, 0.1f, false, "skeleton", "1",
     "size of the cranium, 1 is usual for weight and age"},
    {"tongue_scale", "", "tongue scale", "", 1.0f, tongue_scale_range.low, tongue_scale_range.high,
     &LiveValues::tongue_scale, 0.1f, false, "tissue", "1", "size of the tongue, 1 is usual"},
    {"tissue_stiffness", "patient", "tissue stiffness", "kPa", 1e3f, 1.0f, 100.0f,
     &LiveValues::tissue_stiffness, 1.0f, true, "tissue", "Pa", "Young's modulus of tongue and mucosa"},
    // Above ten times the usual flow (5 ml a minute in a term newborn) drops come out faster than ducts let
    // them.
    {"secretion", "", "secretion", "", 1.0f, 0.0f, 10.0f, &LiveValues::secretion, 5.0f, false, "tissue", "1",
     "what the glands give over what they usually do"},
    {"suction", "", "suction", "", 1.0f, 0.0f, 1.0f, &LiveValues::suction, 0.0f, false, "inputs", "1",
     "suction, 0 to 1"},
}};

std::string LiveField::key() const {
    std::string out(name);
    if (!unit.empty()) {
        out += '_';
        std::ranges::transform(unit, std::back_inserter(out),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    }
    return out;
}

float LiveField::clamped(float quantity) const {
    return std::clamp(quantity, low * per_unit, high * per_unit);
}

const LiveField* live_field(std::string_view name) {
    const auto found = std::ranges::find(live_fields, name, &LiveField::name);
    return found == live_fields.end() ? nullptr : &*found;
}

LiveValues followed(const LiveValues& from, const LiveValues& to, float seconds, float haste) {
    LiveValues out = to;
    for (const LiveField& field : live_fields) {
        if (field.rate > 0.0f) {
            const float now = from.*field.value;
            const float most = haste * field.rate * seconds * (field.of_itself ? now : 1.0f);
            out.*field.value = approach(now, to.*field.value, most);
        }
    }
    return out;
}

LiveValues clamped(const LiveValues& values) {
    LiveValues out = values;
    for (const LiveField& field : live_fields) {
        out.*field.value = field.clamped(values.*field.value);
    }
    return out;
}

}  // namespace eti
