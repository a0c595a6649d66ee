// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "client/render/draw_context.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/render/mesh/scene_meshes.hpp"
#include "client/render/passes/shadow_pass.hpp"

namespace eti::render {

/// The room: bedding, furniture, monitor, and the hands on the tools. It is absent from pictures for
/// measurement. GL state of each function: begin_passes(); samples the maps of the last ShadowPass::draw().
class RoomPass {
  public:
    RoomPass();
    void draw_hands(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows);
    void draw(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows);

  private:
    ShaderProgram& use_matter(const DrawContext& context, const ShadowPass& shadows, const char* define);
    void draw_monitor(const DrawContext& context, const RoomMeshes& room);

    ShaderVariants matter_, flat_, screen_;
    Texture traces_;
};

}  // namespace eti::render
