// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

#include "common/model/field.hpp"
#include "common/model/tools/tools.hpp"

namespace eti {

/// Values that commands change while a session runs; SI. Inputs hold the targets, a snapshot the current
/// values.
struct RuntimeParameters {
    float head_elevation = 0.0f;  ///< [rad], of the skull about the upper neck, positive chin-up
    float jaw_opening = 0.0f;     ///< [rad]
    float table_angle = 0.0f;     ///< [rad], positive head-up; the patient frame tilts with the table
    float head_scale = 1.0f;      ///< cranium, relative to the mean for weight and age
    float tongue_scale = 1.0f;    ///< relative to normal
    float muscle_tone = 0.0f;     ///< of neck, jaw and hyoid: 0 relaxed to 1 awake
    /// [N], of an assistant's fingers on the thyroid cartilage: posterior, superior, to the patient's right
    float laryngeal_pressure_back = 0.0f, laryngeal_pressure_up = 0.0f, laryngeal_pressure_right = 0.0f;
    float tissue_stiffness = 8e3f;  ///< [Pa], Young's modulus of tongue and mucosa
    float secretion = 1.0f;         ///< relative to the glands' normal flow
    float suction = 0.0f;           ///< 0..1
    float view_enhanced = 0.0f;     ///< 0 or 1, like the other view parameters: all aids and the section
    float view_gum_force = 0.0f, view_sight_line = 0.0f, view_glottis = 0.0f, view_axes = 0.0f;
    float view_clock = 0.0f, view_tube_depth = 0.0f, view_warnings = 0.0f;
    float tube_youngs_modulus = Tube{}.youngs_modulus;  ///< [Pa]
    float tube_curve_radius = Tube{}.curve_radius;      ///< [m]

    [[nodiscard]] bool operator==(const RuntimeParameters&) const = default;
};

/// One row of the table of runtime parameters. Scenario reader, command line, commands, their validation, the
/// rate limits, recording and bus all iterate over it, so a parameter is added in one place.
struct RuntimeParameterField : Field<RuntimeParameters> {
    float rate;              ///< [SI per second], limit of the rate of change; 0: immediate
    bool relative;           ///< the rate is relative to the value: a factor of e^rate per second
    std::string_view group;  ///< in a session file
    std::string_view si;     ///< unit in files
    bool on_off = false;     ///< 0 or 1
};

/// Every runtime parameter, in display order.
extern const std::span<const RuntimeParameterField> runtime_parameter_fields;

/// Whether the row has an effect only where bones yield.
[[nodiscard]] bool acts_on_yielding_bones(const RuntimeParameterField& field);

/// The row of a name, or nullptr.
[[nodiscard]] const RuntimeParameterField* find_runtime_parameter(std::string_view name);

/// `from` advanced towards `to` for `seconds`, each value at its own rate times `rate_scale`.
[[nodiscard]] RuntimeParameters advance_towards(const RuntimeParameters& from, const RuntimeParameters& to,
                                                float seconds, float rate_scale);

/// The tube with the runtime parameters applied.
[[nodiscard]] Tube apply_to_tube(Tube tube, const RuntimeParameters& values);

/// Every value clamped to its range.
[[nodiscard]] RuntimeParameters clamped(const RuntimeParameters& values);

}  // namespace eti
