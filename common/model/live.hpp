// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

#include "common/model/field.hpp"
#include "common/model/tools.hpp"

namespace eti {

/// What commands change while a session runs; SI. Inputs carry what is wanted, a snapshot what is.
struct LiveValues {
    float head_elevation = 0.0f;    ///< [rad], of the skull about the upper neck, positive chin-up
    float jaw_opening = 0.0f;       ///< [rad]
    float table_angle = 0.0f;       ///< [rad], positive head-up; the patient frame tilts with the table
    float head_scale = 1.0f;        ///< cranium; 1 is usual for weight and age
    float tongue_scale = 1.0f;      ///< 1 is usual
    float tissue_stiffness = 8e3f;  ///< [Pa], Young's modulus of tongue and mucosa
    float secretion = 1.0f;         ///< of what the glands usually give
    float suction = 0.0f;           ///< 0..1
    float view_enhanced = 0.0f;     ///< 0 or 1, as the others of the view: all aids and the section
    float view_gum_force = 0.0f, view_sight_line = 0.0f, view_glottis = 0.0f, view_axes = 0.0f;
    float view_clock = 0.0f, view_tube_depth = 0.0f, view_warnings = 0.0f;
    float tube_youngs_modulus = Tube{}.youngs_modulus;  ///< [Pa]
    float tube_curve_radius = Tube{}.curve_radius;      ///< [m]

    [[nodiscard]] bool operator==(const LiveValues&) const = default;
};

/// One row of the table of what lives. Scenario reader, command line, commands, their checks, what follows
/// them, recording and bus all walk it, so that a value is added in one place.
struct LiveField : Field<LiveValues> {
    float rate;              ///< [SI per second], by which a scene follows; 0: at once
    bool relative;           ///< the rate is a share of the value: a factor of e^rate a second
    std::string_view group;  ///< of a session file
    std::string_view si;     ///< unit in files
    bool on_off = false;     ///< 0 or 1
};

/// Every value that lives, in the order of display.
extern const std::span<const LiveField> live_fields;

/// The row of a name, or nullptr.
[[nodiscard]] const LiveField* live_field(std::string_view name);

/// `from` carried on towards `to` for `seconds`, each value at its own rate times `haste`.
[[nodiscard]] LiveValues followed(const LiveValues& from, const LiveValues& to, float seconds, float haste);

/// The tube as it lives.
[[nodiscard]] Tube tube_as(Tube tube, const LiveValues& values);

/// Every value within its range.
[[nodiscard]] LiveValues clamped(const LiveValues& values);

}  // namespace eti
