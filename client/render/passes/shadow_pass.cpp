// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/shadow_pass.hpp"

#include <cstring>
#include <span>

#include <fmt/format.h>

#include "client/render/shaders/shaders.hpp"
#include "client/render/views/lip_retraction.hpp"

namespace eti::render {
namespace {

constexpr float room_radius = 0.15f;  // [m], a head and the hand in front of it
constexpr float room_depth = 4.0f * room_radius;
constexpr float lamp_reach = 0.10f;  // [m], beyond it the lamp contributes less than a thousandth
// Anything nearer to the lamp than this [m] is its own glass.
constexpr float lamp_glass = 1.2e-3f;
// The lamp's map is curved: a flat face lies beside its own depth in the map by up to this [m].
constexpr float fine_lamp_bias = 0.15e-3f;
// Coarse faces lie up to some tenths of a millimetre in front of the drawn ones [m].
constexpr float coarse_room_bias = 0.43e-3f, coarse_lamp_bias = 0.3e-3f;

constexpr GLenum room_unit = GL_TEXTURE3, lamp_unit = GL_TEXTURE4;

// Hash that identifies a state of the scene (FNV-1a).
class Digest {
  public:
    template <class Value>
    Digest& add(const Value& value) {
        std::array<unsigned char, sizeof(Value)> bytes{};
        std::memcpy(bytes.data(), &value, sizeof(Value));
        for (const unsigned char byte : bytes) {
            state_ = (state_ ^ byte) * 0x100000001b3ull;
        }
        return *this;
    }
    [[nodiscard]] std::uint64_t state() const { return state_; }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325ull;
};

std::uint64_t state_of(const DrawContext& context, SceneMeshes& meshes, const LiquidSurface& liquid,
                       bool lips_retracted) {
    Digest digest;
    digest.add(meshes.patient().frames_revision());
    digest.add(liquid.casts_shadows() ? liquid.revision : 0);
    if (const auto& pose = context.scene.laryngoscope_pose()) {
        for (int axis = 0; axis < 3; ++axis) {
            digest.add(pose->translation[axis]);
        }
        for (int part = 0; part < 4; ++part) {
            digest.add(pose->rotation.coeffs()[part]);
        }
    }
    if (lips_retracted) {
        const LipRetraction& lips = context.lips;
        for (const float number : lips.axes.reshaped()) {
            digest.add(number);
        }
        digest.add(lips.origin.x()).add(lips.origin.y()).add(lips.origin.z());
        digest.add(lips.upper_shift).add(lips.lower_shift).add(lips.upper_edge).add(lips.lower_edge);
    }
    return digest.state();
}

bool lamp_shadow_of(const DrawContext& context) {
    return context.view.has(Pass::lamp_shadow) && context.lamplit();
}

}  // namespace

ShadowPass::ShadowPass(const Quality& quality)
    : taps_(quality.shadow_taps),
      lens_taps_(quality.lens_taps),
      room_(quality.shadow_size, OutsideShadowMap::lit),
      lamp_(quality.shadow_size, OutsideShadowMap::dark),
      depth_("depth", shaders::mesh_vertex, shaders::flat_fragment),
      drops_("drops' shadows", shaders::drop_shadow_vertex, shaders::drop_shadow_fragment) {}

void ShadowPass::draw(const DrawContext& context, SceneMeshes& meshes, const LiquidSurface& liquid) {
    const Light& room = context.lighting.lights[0];
    if (context.view.has(Pass::room_shadow)) {
        const Eigen::Matrix4f clip = directional_light_matrix(room, context.camera.target, room_radius);
        fill(room_, clip, {nullptr, ShadowLod::coarse, coarse_room_bias, 0.0f, room_depth, clip, nullptr},
             context, meshes, liquid);
    }
    if (lamp_shadow_of(context)) {
        const Light& lamp = context.lighting.lights[1];
        const Eigen::Matrix4f into = world_to_lamp(lamp);
        // The half of a cube in front of the lamp.
        Eigen::Matrix4f half = Eigen::Matrix4f::Identity();
        half.topLeftCorner<2, 2>() /= lamp_reach;
        half(2, 2) = 2.0f / lamp_reach;
        half(2, 3) = -1.0f;
        fill(lamp_, into,
             {"FROM_LAMP", ShadowLod::fine, coarse_lamp_bias, fine_lamp_bias, lamp_reach - lamp_glass,
              half * into, &lamp},
             context, meshes, liquid);
    }
}

void ShadowPass::fill(ShadowMap& map, const Eigen::Matrix4f& world_to_light, const Caster& caster,
                      const DrawContext& context, SceneMeshes& meshes, const LiquidSurface& liquid) {
    const bool lips_retracted = context.view.lips_retracted;
    const std::uint64_t state = state_of(context, meshes, liquid, lips_retracted);
    if (!map.stale(world_to_light, state)) {
        return;
    }
    map.begin(world_to_light, state);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    // Slope-scaled bias against self-shadowing: covers the offset of the samples along both axes of the map
    // (see unshadowed()); 4 steps cover rounding. A lens has more samples, but uses coarse surfaces, whose
    // own bias covers those.
    const float slopes = 2.0f * (1.25f + 0.75f * static_cast<float>(taps_ - 1));
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(slopes, 4.0f);
    ShaderProgram::Defines defines;
    if (caster.define != nullptr) {
        defines.emplace_back(caster.define);
        glEnable(GL_CLIP_DISTANCE0);
    }
    if (lips_retracted) {
        defines.emplace_back("RETRACT");
    }
    ShaderProgram& program = depth_.variant(defines);
    program.use();
    program.set("view_projection", world_to_light);
    program.set("to_lamp", world_to_light);
    program.set("lamp_depths", Eigen::Vector2f(lamp_glass, lamp_reach));
    program.set("clip_plane", no_clipping);
    program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    if (lips_retracted) {
        render::apply(context.lips, program);
    }
    PatientMesh& patient = meshes.patient();
    constexpr float steps = 16777216.0f;  // of a 24-bit depth
    if (context.quality.coarse_shadows) {
        glPolygonOffset(slopes, steps * caster.bias / caster.depth);
        patient.draw(caster.coarse);
    } else {
        glPolygonOffset(slopes, 4.0f + steps * caster.fine_bias / caster.depth);
        const LipRetraction* const lips = lips_retracted ? &context.lips : nullptr;
        const Vec3f from = context.lighting.lights[0].position;
        for (std::size_t part = 0; part < patient.parts().size(); ++part) {
            patient.draw(patient.visible(part, {caster.box, from, no_clipping, lips}, caster.lamp));
        }
    }
    if (meshes.blade() && context.scene.laryngoscope_pose()) {
        program.set("model", matrix_of(*context.scene.laryngoscope_pose()));
        meshes.blade()->draw();
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    if (liquid.casts_shadows()) {
        ShaderProgram& drops = drops_.variant(caster.define != nullptr ? ShaderProgram::Defines{caster.define}
                                                                       : ShaderProgram::Defines{});
        drops.use();
        drops.set("view_projection", world_to_light);
        drops.set("to_lamp", world_to_light);
        drops.set("lamp_depths", Eigen::Vector2f(lamp_glass, lamp_reach));
        drops.set("texels", static_cast<float>(context.quality.shadow_size));
        glEnable(GL_PROGRAM_POINT_SIZE);
        liquid.draw_particles(drops);
        glDisable(GL_PROGRAM_POINT_SIZE);
    }
    glDisable(GL_CLIP_DISTANCE0);
}

ShaderProgram::Defines ShadowPass::defines(const DrawContext& context, bool lamplit) const {
    ShaderProgram::Defines defines{fmt::format("LIGHTS {}", lamplit ? 2 : 1)};
    if (context.view.has(Pass::room_shadow)) {
        defines.emplace_back("ROOM_SHADOW");
    }
    if (lamplit && lamp_shadow_of(context)) {
        defines.emplace_back("LAMP_SHADOW");
    }
    if (context.lighting.environment != nullptr) {
        defines.emplace_back("ENVIRONMENT");
    }
    defines.push_back(fmt::format("TAPS {}", context.view.lens ? lens_taps_ : taps_));
    return defines;
}

void ShadowPass::apply(const DrawContext& context, ShaderProgram& program) const {
    if (context.view.has(Pass::room_shadow)) {
        room_.bind_texture(room_unit);
        program.set("room_depth", static_cast<int>(room_unit - GL_TEXTURE0));
        Eigen::Matrix4f half = 0.5f * Eigen::Matrix4f::Identity();
        half.col(3) = Eigen::Vector4f(0.5f, 0.5f, 0.5f, 1.0f);
        program.set("room_lookup", Eigen::Matrix4f(half * room_.world_to_light()));
    }
    if (lamp_shadow_of(context)) {
        lamp_.bind_texture(lamp_unit);
        program.set("lamp_depth", static_cast<int>(lamp_unit - GL_TEXTURE0));
        program.set("to_lamp", lamp_.world_to_light());
        program.set("lamp_depths", Eigen::Vector2f(lamp_glass, lamp_reach));
    }
}

}  // namespace eti::render
