// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/lighting.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace eti::render {
namespace {

// After the units of the passes: shadow maps, the tube's backdrop, tessellated faces.
constexpr GLenum environment_unit = GL_TEXTURE12;
const Vec3f room_ambient_high(0.34f, 0.36f, 0.40f), room_ambient_low(0.10f, 0.09f, 0.10f);

}  // namespace

void Lighting::apply(ShaderProgram& program, const Vec3f& eye) const {
    program.set("eye", eye);
    program.set("ambient_high", ambient_high);
    program.set("ambient_low", ambient_low);
    program.set("occlusion", occlusion);
    if (environment != nullptr) {
        const Irradiance& room = room_irradiance();
        for (std::size_t k = 0; k < room.size(); ++k) {
            program.set(fmt::format("irradiance[{}]", k), room[k]);
        }
        program.set("environment_gain", ambient_high.mean() / evaluate(room, -Vec3f::UnitY()).mean());
        program.set("environment_map", static_cast<int>(environment_unit - GL_TEXTURE0));
        program.set("roughest_level", EnvironmentMap::rough_level);
        glActiveTexture(environment_unit);
        glBindTexture(GL_TEXTURE_CUBE_MAP, environment->texture().name());
        glActiveTexture(GL_TEXTURE0);
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Light& light = lights[i];
        program.set(fmt::format("light_position[{}]", i), light.position);
        program.set(fmt::format("light_direction[{}]", i), light.direction);
        program.set(fmt::format("light_colour[{}]", i), light.colour);
        program.set(fmt::format("light_shape[{}]", i),
                    Vec3f(light.cos_outer, light.cos_inner, light.reach * light.reach));
    }
}

void Lighting::apply_mouth(ShaderProgram& program, const Landmarks& now) {
    const Vec3f upper = at(now, Landmark::upper_gum), lower = at(now, Landmark::lower_gum);
    const Vec3f middle = 0.5f * (upper + lower);
    constexpr float least = 0.5e-3f;  // [m], of a closed mouth
    const float half = std::max(0.5f * (upper - lower).norm(), least);
    program.set("mouth", Eigen::Vector4f(middle.x(), middle.y(), middle.z(), half));
    program.set("inward", Vec3f((at(now, Landmark::glottis) - middle).normalized()));
}

bool Light::reaches(const Vec3f& centre, float radius) const {
    // One 8-bit step near black, for the brightest reflection of tissue.
    constexpr float unseen = 0.002f;
    const float brightness = colour.maxCoeff();
    const float farthest = reach * std::sqrt(std::max(brightness / unseen - 1.0f, 0.0f));
    const Vec3f way = centre - position;
    if (way.norm() - radius > farthest) {
        return false;
    }
    if (cos_outer <= -1.0f) {
        return true;
    }
    // Distance outside the cone's mantle; behind its tip this underestimates the distance.
    const float along = way.dot(direction);
    const float aside = (way - along * direction).norm();
    const float sin_outer = std::sqrt(std::max(1.0f - cos_outer * cos_outer, 0.0f));
    return aside * cos_outer - along * sin_outer < radius;
}

Vec3f bulb_centre(float blade_length) {
    // 16 mm short of the tip, as on a Miller blade, beneath the plate beside the flange.
    return {2.2e-3f, -0.4e-3f, blade_length - 17e-3f};
}

Light blade_lamp(const RigidTransform& pose, float blade_length) {
    Light lamp;
    lamp.position = pose * (bulb_centre(blade_length) + Vec3f(-0.6e-3f, -1.6e-3f, 2.0e-3f));
    lamp.direction = pose.rotation * Vec3f(0.0f, -0.34f, 0.94f);
    // As bright as a well-lit room at about 15 mm. Below 4 mm the filament's size matters.
    lamp.colour = 14.0f * Vec3f(1.0f, 0.95f, 0.86f);
    lamp.cos_outer = 0.15f;
    lamp.cos_inner = 0.80f;
    lamp.reach = 4e-3f;
    return lamp;
}

namespace {

Lighting room_lighting(const Vec3f& onto, const std::optional<Light>& lamp) {
    Lighting lighting;
    Light& key = lighting.lights[0];
    key.position = onto + Vec3f(0.30f, -0.75f, 0.40f);
    key.direction = (onto - key.position).normalized();
    key.colour = Vec3f(1.60f, 1.52f, 1.42f);
    key.reach = 1.5f;
    if (lamp) {
        lighting.lights[1] = *lamp;
    }
    lighting.ambient_high = room_ambient_high;
    lighting.ambient_low = room_ambient_low;
    return lighting;
}

}  // namespace

Lighting overview_lighting(const Camera& camera, const std::optional<Light>& lamp) {
    return room_lighting(camera.target, lamp);
}

Lighting headset_lighting(const Camera&, const std::optional<Light>& lamp) {
    return room_lighting(Vec3f::Zero(), lamp);
}

Lighting section_lighting(const Camera& camera, const std::optional<Light>&) {
    Lighting lighting;
    Light& key = lighting.lights[0];
    key.position = camera.eye + Vec3f(0.0f, -0.25f, 0.12f);
    key.direction = (camera.target - key.position).normalized();
    key.colour = Vec3f(1.0f, 0.97f, 0.93f);
    key.reach = 2.0f;
    lighting.occlusion = 0.0f;
    lighting.ambient_high = Vec3f(0.36f, 0.36f, 0.38f);
    lighting.ambient_low = Vec3f(0.20f, 0.18f, 0.18f);
    return lighting;
}

Lighting laryngoscope_lighting(const Camera& camera, const std::optional<Light>& lamp) {
    Lighting lighting;
    // The room's light along the line of sight; without a blade, a head lamp.
    Light& eye = lighting.lights[0];
    eye.position = camera.eye - 0.01f * camera.up;
    eye.direction = (camera.target - eye.position).normalized();
    eye.colour = Vec3f::Constant(0.9f);
    eye.reach = 2.0f;
    if (lamp) {
        lighting.lights[1] = *lamp;
    }
    lighting.ambient_high = Vec3f(0.16f, 0.14f, 0.14f);
    lighting.ambient_low = Vec3f(0.06f, 0.04f, 0.04f);
    return lighting;
}

}  // namespace eti::render
