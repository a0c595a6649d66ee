// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/math/transform.hpp"

namespace eti {

/// Named points of the patient, attached to the tissue. The order is that of the bus.
enum class Landmark : std::uint8_t {
    upper_gum,      ///< midpoint of the upper alveolar crest; origin of the patient frame at rest
    lower_gum,      ///< midpoint of the lower alveolar crest
    upper_lip,      ///< lower edge of the upper lip, midline
    lower_lip,      ///< upper edge of the lower lip, midline
    mouth_opening,  ///< centre of the opening between the lips
    tongue_tip,
    tongue_dorsum,  ///< on the tongue's back, midline, above the middle of its body
    vallecula,      ///< deepest point between tongue root and epiglottis
    epiglottis_tip,
    epiglottis_base,    ///< where the epiglottis leaves the tongue root
    glottis,            ///< centre of the glottic opening
    glottis_anterior,   ///< anterior commissure
    glottis_posterior,  ///< interarytenoid notch
    trachea_mid,        ///< centre of the trachea half-way to the carina
    carina,
    oesophagus_inlet,  ///< centre of the upper oesophageal opening
    oesophagus_mid,    ///< centre of the oesophagus at the height of trachea_mid
};
inline constexpr std::size_t landmark_count = 17;

inline constexpr std::array<std::string_view, landmark_count> landmark_names = {
    "upper_gum",        "lower_gum",        "upper_lip",         "lower_lip",      "mouth_opening",
    "tongue_tip",       "tongue_dorsum",    "vallecula",         "epiglottis_tip", "epiglottis_base",
    "glottis",          "glottis_anterior", "glottis_posterior", "trachea_mid",    "carina",
    "oesophagus_inlet", "oesophagus_mid"};

/// Current landmark positions [m], patient frame, indexed by Landmark.
using Landmarks = std::array<Vec3f, landmark_count>;

[[nodiscard]] inline const Vec3f& at(const Landmarks& points, Landmark which) {
    return points[static_cast<std::size_t>(which)];
}

[[nodiscard]] constexpr std::optional<Landmark> find_landmark(std::string_view name) {
    for (std::size_t i = 0; i < landmark_count; ++i) {
        if (landmark_names[i] == name) {
            return static_cast<Landmark>(i);
        }
    }
    return std::nullopt;
}

/// All landmarks at the origin: the state before the first message. (Eigen leaves its vectors uninitialised.)
[[nodiscard]] inline Landmarks zero_landmarks() {
    Landmarks points;
    points.fill(Vec3f::Zero());
    return points;
}

/// Best eye position of an examiner [m], patient frame: on the line from the glottis through a point just
/// below the upper gum (towards the mouth opening), `distance` [m] beyond the gum.
[[nodiscard]] Vec3f best_eye(const Landmarks& points, float distance);
/// The same at threshold::eye_distance.
[[nodiscard]] Vec3f best_eye(const Landmarks& points);

}  // namespace eti
