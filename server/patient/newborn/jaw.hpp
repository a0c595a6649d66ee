// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>

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

}  // namespace eti::patient
