// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace eti {

/// A numeric threshold used in the definitions of metrics.
struct Threshold {
    std::string_view name;
    double value;
    std::string_view unit;
    std::string_view meaning;
    [[nodiscard]] constexpr float as_float() const { return static_cast<float>(value); }
};

/// Incremented with every change of a definition or threshold: metrics of different versions are not
/// comparable. A test checks it against the definitions' text and numbers.
inline constexpr std::uint32_t definitions_version = 1;

// Thresholds without a source are chosen.
namespace threshold {

inline constexpr Threshold gate_slack{
    "gate_slack", 2e-3, "m",
    "Distance beyond a plane at which it counts as passed, and before it at which it counts as left"};
inline constexpr Threshold mouth_radius{
    "mouth_radius", 30e-3, "m",
    "Largest distance of an entering tip from the opening's axis; beyond it the tip passed beside the face"};
inline constexpr Threshold lips_apart{"lips_apart", 3e-3, "m",
                                      "Smallest distance of the lips that defines the plane of the opening"};
inline constexpr Threshold least_attempt{"least_attempt", 0.5, "s",
                                         "Shortest stay of the blade in the mouth that counts as an attempt"};
inline constexpr Threshold peak_prominence{"peak_prominence", 5.0, "deg",
                                           "Least prominence of a maximum of pitch or yaw"};
/// Sampling rate for rocking. Its noise level is taken from the finest wavelet band, a quarter to a half of
/// this rate: 2.5 to 5 Hz, the fastest that a hand rocks a blade. Physiological tremor, 8 to 12 Hz, is
/// averaged out; with finer bins it alone would determine the result.
inline constexpr Threshold curve_rate{"curve_rate", 10.0, "1/s", "Bins of the angle curves for rocking"};
/// Differences between consecutive steps would count the solver's noise as speed.
inline constexpr Threshold speed_rate{"speed_rate", 30.0, "1/s", "Interval over which speeds are computed"};
inline constexpr Threshold look_rate{"look_rate", 30.0, "1/s",
                                     "Interval of the measurements of the glottic view"};
inline constexpr Threshold eye_distance{"eye_distance", 0.3, "m",
                                        "Distance from the upper gum to the eye if no client reports one"};
/// An edge across the opening is resolved to within 2.5 points.
inline constexpr Threshold glottis_points{"glottis_points", 160.0, "1",
                                          "Sample points on the glottic opening"};
inline constexpr Threshold epiglottis_points{"epiglottis_points", 48.0, "1",
                                             "Sample points on the epiglottis"};
inline constexpr Threshold hiding_distance{
    "hiding_distance", 0.5e-3, "m",
    "Occluders closer to a sample point are ignored: the rim on which it lies"};
inline constexpr Threshold most_of_the_glottis{
    "most_of_the_glottis", 50.0, "%", "Visible share at which grade 1 begins and a view counts as held"};
inline constexpr Threshold least_view{"least_view", 5.0, "%",
                                      "Best view below which it is given as the reason of a failure"};
inline constexpr Threshold glottis_radius{"glottis_radius", 6e-3, "m",
                                          "Distance within which the tube's tip is at the glottis, and from "
                                          "the trachea's line within which it passes the glottis"};
inline constexpr Threshold oesophagus_radius{
    "oesophagus_radius", 8e-3, "m",
    "Distance from the oesophagus's line within which the tube's tip passes the inlet"};
inline constexpr Threshold carina_slack{
    "carina_slack", 1e-3, "m",
    "Distance beyond the carina at which it counts as passed, and before it at which it counts as left"};
inline constexpr Threshold success_depth{"success_depth", 10e-3, "m",
                                         "Depth past the glottis that counts as intubated"};

}  // namespace threshold

/// All thresholds.
inline constexpr Threshold thresholds[] = {
    threshold::gate_slack,          threshold::mouth_radius,      threshold::lips_apart,
    threshold::least_attempt,       threshold::peak_prominence,   threshold::curve_rate,
    threshold::speed_rate,          threshold::look_rate,         threshold::eye_distance,
    threshold::glottis_points,      threshold::epiglottis_points, threshold::hiding_distance,
    threshold::most_of_the_glottis, threshold::least_view,        threshold::glottis_radius,
    threshold::oesophagus_radius,   threshold::carina_slack,      threshold::success_depth,
};

}  // namespace eti
