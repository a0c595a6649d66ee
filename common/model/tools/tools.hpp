// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/field.hpp"

namespace eti {

enum class Tool : std::uint8_t { laryngoscope, tube };

/// A capsule between `a` and `b` [m] with radius `radius` [m].
struct Capsule {
    Vec3f a = Vec3f::Zero();
    Vec3f b = Vec3f::Zero();
    float radius = 0.0f;
};

enum class Blade : std::uint8_t { miller_0, miller_1 };

/// The laryngoscope in its own frame: origin where blade and handle meet, +z along the blade to its tip, +y
/// along the handle away from the blade, +x = y cross z. +y is the direction of lift, and the side of the
/// blade that carries the tongue. The three capsules of Xiao et al. 2020, sec. 4.3: handle, proximal blade,
/// distal blade.
struct Laryngoscope {
    Blade blade = Blade::miller_1;
    float blade_length = 0.1f;          ///< [m], origin to tip
    std::array<Capsule, 3> capsules{};  ///< handle, proximal blade, distal blade
    [[nodiscard]] Vec3f tip() const { return {0.0f, 0.0f, blade_length}; }
};

/// Miller 0: 76 mm, Miller 1: 100 mm (manufacturers' catalogues give 75-80 and 100 mm).
[[nodiscard]] Laryngoscope make_laryngoscope(Blade blade);

/// The visible laryngoscope (blade as a thin curved plate with flange, handle), closed, tool frame.
[[nodiscard]] TriangleMesh laryngoscope_mesh(const Laryngoscope& scope);

[[nodiscard]] std::string_view name_of(Blade blade);

/// An endotracheal tube. Tool frame of a tracked tube: origin at the grip on the centre line,
/// +z along the tube towards its tip, +y the concave side of its curve.
struct Tube {
    float inner_diameter = 3.0e-3f;  ///< [m]
    float outer_diameter = 4.2e-3f;  ///< [m]
    float length = 0.16f;            ///< [m], connector to tip
    float youngs_modulus = 15e6f;    ///< [Pa], PVC (10-20 MPa)
    float grip_from_tip = 0.10f;     ///< [m], where the tracked hand holds it
    float curve_radius = 0.14f;      ///< [m], the manufactured curve of an uncuffed tube
    [[nodiscard]] float outer_radius() const { return 0.5f * outer_diameter; }
    [[nodiscard]] float inner_radius() const { return 0.5f * inner_diameter; }
    [[nodiscard]] float bending_stiffness() const;  ///< E I [N m^2] of the hollow section
};

/// Pose at arc length `length` [m] from the origin of a tool with `curvature` [1/m] towards +y, in its own
/// frame with +z tangential. An arc slides along itself, so this is also the motion that advances the tool by
/// `length`.
[[nodiscard]] RigidTransform along_arc(float curvature, float length);

/// Arc length [m] from the origin of a tool with `curvature` [1/m] to its closest point to `point`, in its
/// own frame.
[[nodiscard]] float arc_length_to(float curvature, const Vec3f& point);

/// The tube's fields in a scenario; its runtime parameters are in runtime_parameter_fields.
extern const std::array<Field<Tube>, 3> tube_fields;

/// Outer diameter [m] of a tube with the given inner diameter [m]: 3.6, 4.2, 4.9 mm for 2.5, 3.0, 3.5 mm,
/// linear between and beyond.
[[nodiscard]] float outer_diameter_of(float inner_diameter);

/// Recommended depth [m] of a tube at the lip: weight [kg] plus 6, in cm (Tochen 1979; mid-tracheal in 51 %,
/// Peng 2020).
[[nodiscard]] constexpr double tube_depth_by_weight(double weight) {
    return 0.01 * (weight + 6.0);
}

}  // namespace eti
