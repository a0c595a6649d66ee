// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/smoothstep.hpp"
#include "common/math/transform.hpp"
#include "common/math/units.hpp"

// Kinematics of the jaw in the newborn's model coordinates: x left, y anterior, z superior; millimetres of
// the 3.5 kg term newborn.
namespace eti::patient {

inline const Vec3f jaw_joint(0.0f, 2.0f, 13.0f);
/// Jaw opening at which the model is sampled, so that the lips are apart; posture adds to it.
constexpr float parted_lips_deg = 4.0f;
constexpr float jaw_slide_per_deg = 0.12f;

/// Maps a point of the jaw opened by `degrees` to the coordinates of the closed jaw.
[[nodiscard]] inline Vec3f turn_about_jaw(const Vec3f& p, float degrees) {
    const float c = std::cos(degrees * degree);
    const float s = std::sin(degrees * degree);
    const float a = p.y() - jaw_joint.y();
    const float z = p.z() - jaw_joint.z();
    return {p.x(), jaw_joint.y() + a * c - z * s - jaw_slide_per_deg * degrees,
            jaw_joint.z() + a * s + z * c};
}

[[nodiscard]] inline Vec3f turn_back_about_jaw(Vec3f p, float degrees) {
    p.y() += jaw_slide_per_deg * degrees;
    const float c = std::cos(degrees * degree);
    const float s = std::sin(degrees * degree);
    const float a = p.y() - jaw_joint.y();
    const float z = p.z() - jaw_joint.z();
    return {p.x(), jaw_joint.y() + a * c + z * s, jaw_joint.z() - a * s + z * c};
}

/// Fraction of the jaw's motion that skin follows: a sharp transition at the mouth opening, a wide one in the
/// cheek, which stretches. `rest_jaw_deg`: opening of the modelled jaw.
[[nodiscard]] inline float jaw_share(const Vec3f& p, float rest_jaw_deg) {
    // Height below the surface half-way between the jaws, as an angle about the jaw joint.
    const Vec3f half = turn_about_jaw(p, rest_jaw_deg * 0.5f);
    const float radius = std::hypot(p.y() - jaw_joint.y(), p.z() - jaw_joint.z());
    const float below = (-6.3f - half.z()) / std::max(radius, 1.0f);
    const float turned = std::atan2(jaw_joint.z() - p.z(), p.y() - jaw_joint.y());
    const float parted = smoothstep(28, 34, p.y()) * (1.0f - smoothstep(11, 15, std::fabs(p.x())));
    const float half_width = (14.0f + (0.5f - 14.0f) * parted) * degree;
    return smoothstep(-half_width, half_width, below) *
           (1.0f - smoothstep(56 * degree, 82 * degree, turned)) * smoothstep(-4, 8, p.y());
}

}  // namespace eti::patient
