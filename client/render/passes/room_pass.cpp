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

void RoomPass::draw(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows) {
    const RoomMeshes& room = meshes.room();
    if (context.ids() || !room.bedding()) {
        return;
    }
    const auto use = [&](const char* define) -> ShaderProgram& {
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
    };
    if (context.from.hands) {
        for (const RoomMeshes::Hand& hand : room.hands()) {
            place(use(nullptr), context, matrix_of(hand.pose), no_clipping);
            hand.mesh->draw();
        }
    }
    place(use("TERRY"), context, Eigen::Matrix4f::Identity(), no_clipping);
    room.bedding()->draw();
    place(use(nullptr), context, matrix_of(room.pose()), no_clipping);
    room.furniture()->draw();
    ShaderProgram& glow = flat_.variant({});
    glow.use();
    place(glow, context, matrix_of(room.pose()), no_clipping);
    glow.set("flat_colour", element);
    room.glowing()->draw();
    draw_monitor(context, room);
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
    room.screen()->draw();
    glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace eti::render
