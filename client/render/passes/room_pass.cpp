// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/room_pass.hpp"

#include <cmath>

#include "client/render/shaders/shaders.hpp"

namespace eti::render {
namespace {

constexpr GLenum traces_unit = GL_TEXTURE0;
const Eigen::Vector4f element(1.9f, 0.62f, 0.22f,
                              1.0f);  // linear light of the warmer and, whiter, of luminaires

// Whether a sphere may be visible: it lies beyond none of the frustum's planes.
bool in_view(const Eigen::Matrix4f& view_projection, const Vec3f& centre, float radius) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            const Eigen::Vector4f plane =
                (view_projection.row(3) + side * view_projection.row(axis)).transpose();
            if (plane.head<3>().dot(centre) + plane.w() < -radius * plane.head<3>().norm()) {
                return false;
            }
        }
    }
    return true;
}

// Whether the view's lens looks into the mouth from within: it sees nothing else.
bool in_mouth(const DrawContext& context) {
    constexpr float within = 4e-3f;     // [m] past the middle of the mouth's opening
    constexpr float most_aside = 0.7f;  // cosine between gaze and airway
    if (!context.view.lens) {
        return false;
    }
    const Landmarks& now = context.scene.landmarks();
    const Vec3f mouth = at(now, Landmark::mouth_opening);
    const Vec3f inward = (at(now, Landmark::glottis) - mouth).normalized();
    const Vec3f gaze = (context.camera.target - context.camera.eye).normalized();
    return (context.camera.eye - mouth).dot(inward) > within && gaze.dot(inward) > most_aside;
}

// A number on the monitor's screen; negative: none.
int shown(float measure) {
    return std::isfinite(measure) ? static_cast<int>(std::lround(measure)) : -1;
}

}  // namespace

RoomPass::RoomPass()
    : matter_("room", shaders::room_vertex, shaders::room_fragment),
      flat_("glow", shaders::mesh_vertex, shaders::flat_fragment),
      screen_("monitor", shaders::mesh_vertex, shaders::monitor_fragment) {
    glBindTexture(GL_TEXTURE_2D, traces_.name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, PulseTraces::columns, 1, 0, GL_RGBA, GL_FLOAT, nullptr);
    set_filter(GL_NEAREST);
    glBindTexture(GL_TEXTURE_2D, 0);
}

ShaderProgram& RoomPass::use_matter(const DrawContext& context, const ShadowPass& shadows,
                                    const char* define) {
    ShaderProgram::Defines defines = shadows.defines(context, false);
    if (context.quality.fine) {
        defines.emplace_back("FINE");
    }
    if (define != nullptr) {
        defines.emplace_back(define);
    }
    ShaderProgram& program = matter_.variant(defines);
    program.use();
    context.lighting.apply(program, context.camera.eye);
    shadows.apply(context, program);
    return program;
}

void RoomPass::draw_hands(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows) {
    if (context.ids() || !context.from.hands || in_mouth(context)) {
        return;
    }
    for (const RoomMeshes::Hand& hand : meshes.room().hands()) {
        place(use_matter(context, shadows, nullptr), context, matrix_of(hand.pose), no_clipping);
        (context.quality.fine ? hand.fine : hand.coarse)->draw();
    }
}

void RoomPass::draw(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows) {
    const RoomMeshes& room = meshes.room();
    const bool omitted = context.view.near_only && !context.quality.walls;
    if (context.ids() || !room.bedding() || omitted || in_mouth(context)) {
        return;
    }
    place(use_matter(context, shadows, "TERRY"), context, Eigen::Matrix4f::Identity(), no_clipping);
    room.bedding()->draw(!context.quality.fine);
    place(use_matter(context, shadows, nullptr), context, matrix_of(room.pose()), no_clipping);
    for (const RoomMeshes::Part& part : room.furniture()) {
        if ((part.near || context.quality.walls) &&
            in_view(context.view_projection, room.pose() * part.centre, part.radius)) {
            part.mesh.draw();
        }
    }
    if (context.quality.walls) {
        ShaderProgram& glow = flat_.variant({});
        glow.use();
        place(glow, context, matrix_of(room.pose()), no_clipping);
        glow.set("flat_colour", element);
        room.glowing()->draw();
    }
    const RoomMeshes::Screen& screen = *room.screen();
    if (in_view(context.view_projection, room.pose() * screen.centre, screen.radius)) {
        draw_monitor(context, room);
    }
}

void RoomPass::draw_monitor(const DrawContext& context, const RoomMeshes& room) {
    glActiveTexture(traces_unit);
    glBindTexture(GL_TEXTURE_2D, traces_.name());
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, PulseTraces::columns, 1, GL_RGBA, GL_FLOAT,
                    room.traces().values().data());
    ShaderProgram& program = screen_.variant({});
    program.use();
    place(program, context, matrix_of(room.pose()), no_clipping);
    program.set("traces", static_cast<int>(traces_unit - GL_TEXTURE0));
    program.set("head", room.traces().head());
    program.set("heart_rate", shown(context.scene.measures().heart_rate_per_min));
    program.set("saturation", shown(context.scene.measures().oxygen_saturation_percent));
    room.screen()->mesh.draw();
    glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace eti::render
