// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>

#include "client/render/camera.hpp"
#include "client/render/shader_program.hpp"
#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"

namespace eti::render {

/// A spot light; a lamp that shines all round has cone cosines below -1.
struct Light {
    Vec3f position = Vec3f::Zero();     ///< [m]
    Vec3f direction = -Vec3f::UnitZ();  ///< unit, where it shines to
    Vec3f colour = Vec3f::Zero();       ///< linear; black switches it off
    float cos_outer = -3.0f, cos_inner = -2.0f;
    float reach = 1.0f;  ///< [m] where half of the strength is left; far beyond it falls with the square

    /// Whether anything within `radius` [m] of `centre` may be lit by it, as far as one could tell.
    [[nodiscard]] bool reaches(const Vec3f& centre, float radius) const;
};

/// What lights a view: light 0 may throw shadows.
struct Lighting {
    std::array<Light, 2> lights{};
    Vec3f ambient_high = Vec3f::Zero();  ///< linear, from the ceiling (the patient's anterior)
    Vec3f ambient_low = Vec3f::Zero();   ///< linear, from the table
    float occlusion = 1.0f;  ///< 0-1: how much of the room's light hollows are kept from; 0: cut open

    /// Sets the program's uniforms; the program must be in use.
    void apply(ShaderProgram& program, const Vec3f& eye) const;
    /// The same for programs that ask how much of the room's light comes in through the mouth.
    static void apply_mouth(ShaderProgram& program, const Landmarks& now);
};

/// Of the lamp's bulb in the laryngoscope's frame [m].
[[nodiscard]] Vec3f bulb_centre(float blade_length);

/// The laryngoscope's own lamp, near the blade's tip on the side away from the tongue: before its bulb.
/// `blade_length` [m] from the tool's origin to the tip.
[[nodiscard]] Light blade_lamp(const RigidTransform& pose, float blade_length);

[[nodiscard]] Lighting overview_lighting(const Camera& camera, const std::optional<Light>& lamp);
/// The cut is lit by the room alone.
[[nodiscard]] Lighting section_lighting(const Camera& camera, const std::optional<Light>& lamp);
/// Both eyes of a headset see the same room: its lamp hangs above the table.
[[nodiscard]] Lighting worn_lighting(const Camera& camera, const std::optional<Light>& lamp);
[[nodiscard]] Lighting laryngoscope_lighting(const Camera& camera, const std::optional<Light>& lamp);

}  // namespace eti::render
