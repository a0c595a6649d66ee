// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>

#include "client/render/gl/shader_program.hpp"
#include "client/render/room/environment.hpp"
#include "client/render/views/camera.hpp"
#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"

namespace eti::render {

/// A spot light; for a point light the cone cosines are below -1.
struct Light {
    Vec3f position = Vec3f::Zero();     ///< [m]
    Vec3f direction = -Vec3f::UnitZ();  ///< unit, direction of the light
    Vec3f colour = Vec3f::Zero();       ///< linear; black switches the light off
    float cos_outer = -3.0f, cos_inner = -2.0f;
    float reach = 1.0f;  ///< [m] distance at half intensity; far beyond it follows the inverse square law

    /// Conservative test: whether the light may reach anything within `radius` [m] of `centre`.
    [[nodiscard]] bool reaches(const Vec3f& centre, float radius) const;
};

/// Lights of a view; light 0 may cast shadows.
struct Lighting {
    std::array<Light, 2> lights{};
    Vec3f ambient_high = Vec3f::Zero();  ///< linear, from the ceiling (the patient's anterior)
    Vec3f ambient_low = Vec3f::Zero();   ///< linear, from the table
    /// Replaces the two colours above, as bright from the ceiling as the first; may be null.
    const EnvironmentMap* environment = nullptr;
    float occlusion = 1.0f;  ///< 0-1: how much ambient light occluded cavities lose; 0 for a section

    /// Sets the program's uniforms; the program must be in use.
    void apply(ShaderProgram& program, const Vec3f& eye) const;
    /// Sets the uniforms of programs that compute the ambient light entering through the mouth.
    static void apply_mouth(ShaderProgram& program, const Landmarks& now);
};

/// Centre of the lamp's bulb in the laryngoscope's frame [m].
[[nodiscard]] Vec3f bulb_centre(float blade_length);

/// The laryngoscope's lamp, in front of its bulb near the blade's tip on the side away from the tongue.
/// `blade_length` [m] from the tool's origin to the tip.
[[nodiscard]] Light blade_lamp(const RigidTransform& pose, float blade_length);

[[nodiscard]] Lighting overview_lighting(const Camera& camera, const std::optional<Light>& lamp);
/// A section is lit by the room only.
[[nodiscard]] Lighting section_lighting(const Camera& camera, const std::optional<Light>& lamp);
/// Both eyes of a headset share the room's lighting: the lamp hangs above the table.
[[nodiscard]] Lighting headset_lighting(const Camera& camera, const std::optional<Light>& lamp);
[[nodiscard]] Lighting laryngoscope_lighting(const Camera& camera, const std::optional<Light>& lamp);

}  // namespace eti::render
