// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>
#include <span>
#include <string_view>

namespace eti {

/// Values that are shown while a session runs, as of one step, in the units of session files and messages.
/// NaN: missing.
struct LiveMeasures {
    static constexpr float missing = std::numeric_limits<float>::quiet_NaN();

    float gum_force_n = 0.0f;
    float glottic_opening_percent = 0.0f;
    float tube_depth_past_glottis = -1.0f;  ///< [m]
    float tube_force_n = 0.0f;
    float tongue_force_n = missing;
    float epiglottis_in_sight = 0.0f;  ///< 0 or 1
    float oxygen_saturation_percent = missing;
    float heart_rate_per_min = missing;

    [[nodiscard]] bool operator==(const LiveMeasures&) const = default;
};

/// One row of the table of live measures.
struct LiveMeasureField {
    std::string_view key{};  ///< in messages, and in the group `metrics` of a session file
    float LiveMeasures::*value = nullptr;
    std::string_view label{}, short_label{};  ///< the second above a plot
    std::string_view si{}, unit{};            ///< unit in messages and files; as shown
    float per_unit = 1.0f;                    ///< value in files of one shown unit
    /// Scale of a plot, as shown: smaller values are cut off, greater ones extend it; 0 to 0: not plotted.
    float plot_low = 0.0f, plot_high = 0.0f;
    /// As shown; where `bad` is the smaller one, small values are bad. NaN: no limit.
    float warning = LiveMeasures::missing, bad = LiveMeasures::missing;
    bool peaks = false;     ///< several steps are summed up by their greatest value, else by the last
    bool optional = false;  ///< not simulated in every session, or not part of older session files
    std::string_view help{};
};

/// Every live measure, in display order. Session file, messages, replay, the panel's plots and the report's
/// time line iterate over it, so a measure is added in one place.
extern const std::span<const LiveMeasureField> live_measure_fields;

/// The row of a member.
[[nodiscard]] const LiveMeasureField& live_measure(float LiveMeasures::*value);

}  // namespace eti
