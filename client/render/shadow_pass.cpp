// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/shadow_pass.hpp"

#include <cstring>
#include <span>

#include <fmt/format.h>

#include "client/render/lip_retraction.hpp"
#include "client/render/mesh_shaders.hpp"

namespace eti::render {
namespace {

constexpr float room_radius = 0.15f;  // [m], a head and the hand before it
constexpr float room_depth = 4.0f * room_radius;
constexpr float lamp_reach = 0.10f;  // [m], beyond it the lamp gives less than a thousandth
// What lies nearer to the lamp than this [m] is its own glass.
constexpr float lamp_glass = 1.2e-3f;
// Coarse faces lie up to some tenths of a millimetre before those that are drawn [m].
constexpr float coarse_room_bias = 0.43e-3f, coarse_lamp_bias = 0.3e-3f;

constexpr GLenum room_unit = GL_TEXTURE3, lamp_unit = GL_TEXTURE4;

// Tells states of the scene apart (FNV-1a).
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

std::uint64_t state_of(const Drawing& drawing, SceneMeshes& meshes, bool lips_aside) {
    Digest digest;
    digest.add(meshes.patient().frames_revision());
    if (const auto& pose = drawing.scene.laryngoscope_pose()) {
        for (int axis = 0; axis < 3; ++axis) {
            digest.add(pose->translation[axis]);
        }
        for (int part = 0; part < 4; ++part) {
            digest.add(pose->rotation.coeffs()[part]);
        }
    }
    if (lips_aside) {
        const LipRetraction& lips = drawing.lips;
        for (const float number : lips.axes.reshaped()) {
            digest.add(number);
        }
        digest.add(lips.origin.x()).add(lips.origin.y()).add(lips.origin.z());
        digest.add(lips.upper_shift).add(lips.lower_shift).add(lips.upper_edge).add(lips.lower_edge);
    }
    return digest.state();
}

bool lamp_shadow_of(const Drawing& drawing) {
    return drawing.view.has(Pass::lamp_shadow) && drawing.lamplit();
}

}  // namespace

ShadowPass::ShadowPass(const Quality& quality)
    : taps_(quality.shadow_taps),
      lens_taps_(quality.lens_taps),
      room_(quality.shadow_size, Beyond::lit),
      lamp_(quality.shadow_size, Beyond::dark),
      depth_("depth", source::mesh_vertex, std::string(source::flat_fragment)) {}

void ShadowPass::draw(const Drawing& drawing, SceneMeshes& meshes) {
    const Light& room = drawing.lighting.lights[0];
    if (drawing.view.has(Pass::room_shadow)) {
        const Eigen::Matrix4f clip = parallel_clip(room, drawing.camera.target, room_radius);
        fill(room_, clip, {nullptr, Coarse::far_off, coarse_room_bias, room_depth, clip, nullptr}, drawing,
             meshes);
    }
    if (lamp_shadow_of(drawing)) {
        const Light& lamp = drawing.lighting.lights[1];
        const Eigen::Matrix4f into = into_lamp(lamp);
        // The half of a cube that lies before it.
        Eigen::Matrix4f half = Eigen::Matrix4f::Identity();
        half.topLeftCorner<2, 2>() /= lamp_reach;
        half(2, 2) = 2.0f / lamp_reach;
        half(2, 3) = -1.0f;
        fill(lamp_, into,
             {"FROM_LAMP", Coarse::close, coarse_lamp_bias, lamp_reach - lamp_glass, half * into, &lamp},
             drawing, meshes);
    }
}

void ShadowPass::fill(ShadowMap& map, const Eigen::Matrix4f& into_light, const Caster& caster,
                      const Drawing& drawing, SceneMeshes& meshes) {
    const bool lips_aside = drawing.view.lips_aside;
    const std::uint64_t state = state_of(drawing, meshes, lips_aside);
    if (!map.stale(into_light, state)) {
        return;
    }
    map.begin(into_light, state);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    // Slope-scaled bias against a surface shading itself: as far as looks into the map lie aside, along both
    // of its axes (see unshadowed()). 4 steps cover what rounding leaves. Where a lens has more of them,
    // shadows are of coarse surfaces, whose own bias covers those.
    const float slopes = 2.0f * (1.25f + 0.75f * static_cast<float>(taps_ - 1));
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(slopes, 4.0f);
    ShaderProgram::Defines defines;
    if (caster.define != nullptr) {
        defines.emplace_back(caster.define);
        glEnable(GL_CLIP_DISTANCE0);
    }
    if (lips_aside) {
        defines.emplace_back("RETRACT");
    }
    ShaderProgram& program = depth_.with(defines);
    program.use();
    program.set("view_projection", into_light);
    program.set("to_lamp", into_light);
    program.set("lamp_depths", Eigen::Vector2f(lamp_glass, lamp_reach));
    program.set("clip_plane", no_clipping);
    program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    if (lips_aside) {
        render::apply(drawing.lips, program);
    }
    PatientMesh& patient = meshes.patient();
    if (drawing.quality.coarse_shadows) {
        constexpr float steps = 16777216.0f;  // of a depth of 24 bits
        glPolygonOffset(slopes, steps * caster.bias / caster.depth);
        patient.draw(caster.coarse);
    } else {
        const LipRetraction* const lips = lips_aside ? &drawing.lips : nullptr;
        const Vec3f from = drawing.lighting.lights[0].position;
        for (std::size_t part = 0; part < patient.parts().size(); ++part) {
            patient.draw(patient.visible(part, {caster.box, from, no_clipping, lips}, caster.lamp));
        }
    }
    if (meshes.blade() && drawing.scene.laryngoscope_pose()) {
        program.set("model", matrix_of(*drawing.scene.laryngoscope_pose()));
        meshes.blade()->draw();
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_CLIP_DISTANCE0);
}

ShaderProgram::Defines ShadowPass::defines(const Drawing& drawing, bool lamplit) const {
    ShaderProgram::Defines defines{fmt::format("LIGHTS {}", lamplit ? 2 : 1)};
    if (drawing.view.has(Pass::room_shadow)) {
        defines.emplace_back("ROOM_SHADOW");
    }
    if (lamplit && lamp_shadow_of(drawing)) {
        defines.emplace_back("LAMP_SHADOW");
    }
    defines.push_back(fmt::format("TAPS {}", drawing.view.lens ? lens_taps_ : taps_));
    return defines;
}

void ShadowPass::apply(const Drawing& drawing, ShaderProgram& program) const {
    if (drawing.view.has(Pass::room_shadow)) {
        room_.bind_texture(room_unit);
        program.set("room_depth", static_cast<int>(room_unit - GL_TEXTURE0));
        Eigen::Matrix4f half = 0.5f * Eigen::Matrix4f::Identity();
        half.col(3) = Eigen::Vector4f(0.5f, 0.5f, 0.5f, 1.0f);
        program.set("room_lookup", Eigen::Matrix4f(half * room_.into_light()));
    }
    if (lamp_shadow_of(drawing)) {
        lamp_.bind_texture(lamp_unit);
        program.set("lamp_depth", static_cast<int>(lamp_unit - GL_TEXTURE0));
        program.set("to_lamp", lamp_.into_light());
        program.set("lamp_depths", Eigen::Vector2f(lamp_glass, lamp_reach));
    }
}

}  // namespace eti::render
