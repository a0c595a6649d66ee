// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/tools.hpp"

#include <cmath>
#include <numbers>

#include "common/math/units.hpp"

namespace eti {

const std::array<Field<Tube>, 3> tube_fields = {{
    {"inner_diameter", "tube", "inner diameter", "mm", millimetre, 2.0f, 4.5f, &Tube::inner_diameter,
     "The tube's size; the outer diameter follows (3.6, 4.2, 4.9 mm for 2.5, 3.0, 3.5)"},
    {"length", "tube", "length", "mm", millimetre, 100.0f, 250.0f, &Tube::length, "Connector to tip"},
    {"grip_from_tip", "tube", "grip from tip", "mm", millimetre, 40.0f, 200.0f, &Tube::grip_from_tip,
     "Distance of the grip from the tip, at most the length; a grip farther back lets the tube bend and "
     "buckle more"},
}};

Laryngoscope make_laryngoscope(Blade blade) {
    Laryngoscope scope;
    scope.blade = blade;
    const bool smaller = blade == Blade::miller_0;
    scope.blade_length = smaller ? 0.076f : 0.100f;
    const float proximal = smaller ? 4.2e-3f : 5.0e-3f;
    const float distal = smaller ? 3.0e-3f : 3.5e-3f;
    const float joint = 0.55f * scope.blade_length;
    scope.capsules = {Capsule{{0, 0.014f, 0}, {0, 0.12f, 0}, 9e-3f},
                      Capsule{{0, 0, 0}, {0, 0, joint}, proximal},
                      Capsule{{0, 0, joint}, {0, 0, scope.blade_length - distal}, distal}};
    return scope;
}

std::string_view name_of(Blade blade) {
    return blade == Blade::miller_0 ? "miller_0" : "miller_1";
}

float outer_diameter_of(float inner_diameter) {
    constexpr std::array<std::array<float, 2>, 3> table = {
        {{2.5e-3f, 3.6e-3f}, {3.0e-3f, 4.2e-3f}, {3.5e-3f, 4.9e-3f}}};
    const std::size_t k = inner_diameter < table[1][0] ? 0 : 1;
    const float slope = (table[k + 1][1] - table[k][1]) / (table[k + 1][0] - table[k][0]);
    return table[k][1] + slope * (inner_diameter - table[k][0]);
}

RigidTransform along_arc(float curvature, float length) {
    const float angle = curvature * length;
    if (std::fabs(angle) < 1e-5f) {
        return {Quatf::Identity(), Vec3f(0, 0, length)};
    }
    // Turning about -x takes +z towards +y.
    return {Quatf(Eigen::AngleAxisf(-angle, Vec3f::UnitX())),
            Vec3f(0, (1.0f - std::cos(angle)) / curvature, std::sin(angle) / curvature)};
}

float arc_length_to(float curvature, const Vec3f& point) {
    return std::fabs(curvature) < 1e-3f
               ? point.z()
               : std::atan2(curvature * point.z(), 1.0f - curvature * point.y()) / curvature;
}

float Tube::bending_stiffness() const {
    const float outer = outer_diameter * outer_diameter * outer_diameter * outer_diameter;
    const float inner = inner_diameter * inner_diameter * inner_diameter * inner_diameter;
    return youngs_modulus * std::numbers::pi_v<float> / 64.0f * (outer - inner);
}

}  // namespace eti
