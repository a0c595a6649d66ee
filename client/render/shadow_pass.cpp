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
constexpr float lamp_reach = 0.10f;   // [m], beyond it the lamp gives less than a thousandth

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
      room_(quality.shadow_size, Beyond::lit),
      lamp_(quality.shadow_size, Beyond::dark),
      depth_("depth", {}, source::mesh_vertex, source::flat_fragment),
      depth_retracted_("depth with lips held aside", {"RETRACT"}, source::mesh_vertex,
                       source::flat_fragment) {}

void ShadowPass::draw(const Drawing& drawing, SceneMeshes& meshes) {
    const Light& room = drawing.lighting.lights[0];
    if (drawing.view.has(Pass::room_shadow)) {
        fill(room_, parallel_clip(room, drawing.camera.target, room_radius), drawing, meshes, Coarse::far_off,
             drawing.view.lips_aside);
    }
    if (lamp_shadow_of(drawing)) {
        fill(lamp_, cone_clip(drawing.lighting.lights[1], lamp_reach), drawing, meshes, Coarse::close,
             drawing.view.lips_aside);
    }
}

void ShadowPass::fill(ShadowMap& map, const Eigen::Matrix4f& clip, const Drawing& drawing,
                      SceneMeshes& meshes, Coarse coarse, bool lips_aside) {
    const std::uint64_t state = state_of(drawing, meshes, lips_aside);
    if (!map.stale(clip, state)) {
        return;
    }
    map.begin(clip, state);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    // Slope-scaled bias against a surface shading itself; 4 steps cover half a texel's slope of 60 deg.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2.5f, 4.0f);
    ShaderProgram& program = lips_aside ? depth_retracted_ : depth_;
    program.use();
    program.set("view_projection", clip);
    program.set("clip_plane", no_clipping);
    program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    if (lips_aside) {
        render::apply(drawing.lips, program);
    }
    PatientMesh& patient = meshes.patient();
    if (drawing.quality.coarse_shadows) {
        // Coarse faces lie up to some tenths of a millimetre before those that are drawn: of the room's map
        // of 0.6 m, and of the lamp's at 20 mm, a quarter to a half of one.
        glPolygonOffset(2.5f, 12000.0f);
        patient.draw(coarse);
    } else {
        const LipRetraction* const lips = lips_aside ? &drawing.lips : nullptr;
        const Vec3f from = drawing.lighting.lights[0].position;
        for (std::size_t part = 0; part < patient.parts().size(); ++part) {
            patient.draw(patient.visible(part, {clip, from, no_clipping, lips}));
        }
    }
    if (meshes.blade() && drawing.scene.laryngoscope_pose()) {
        program.set("model", matrix_of(*drawing.scene.laryngoscope_pose()));
        meshes.blade()->draw();
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
}

ShaderProgram::Defines ShadowPass::defines(const Drawing& drawing, bool lamplit) const {
    ShaderProgram::Defines defines{fmt::format("LIGHTS {}", lamplit ? 2 : 1)};
    if (drawing.view.has(Pass::room_shadow)) {
        defines.emplace_back("ROOM_SHADOW");
    }
    if (lamplit && lamp_shadow_of(drawing)) {
        defines.emplace_back("LAMP_SHADOW");
    }
    defines.push_back(fmt::format("TAPS {}", taps_));
    return defines;
}

void ShadowPass::apply(const Drawing& drawing, ShaderProgram& program) const {
    if (drawing.view.has(Pass::room_shadow)) {
        room_.bind_texture(room_unit);
        program.set("room_map", static_cast<int>(room_unit - GL_TEXTURE0));
        program.set("room_lookup", room_.lookup());
    }
    if (lamp_shadow_of(drawing)) {
        lamp_.bind_texture(lamp_unit);
        program.set("lamp_map", static_cast<int>(lamp_unit - GL_TEXTURE0));
        program.set("lamp_lookup", lamp_.lookup());
    }
}

}  // namespace eti::render
