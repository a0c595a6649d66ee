// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/shader_family.hpp"
#include "client/render/shadow_pass.hpp"

namespace eti::render {

/// The patient's surfaces: skin, mucosa, cords.
class PatientPass {
  public:
    PatientPass();
    void draw(const Drawing& drawing, SceneMeshes& meshes, const ShadowPass& shadows);

  private:
    [[nodiscard]] ShaderProgram& program(const Drawing& drawing, const ShadowPass& shadows, bool lamplit,
                                         bool filmed);
    /// Everything, or with a lamp what it reaches or does not.
    void draw_parts(const Drawing& drawing, PatientMesh& patient, const ShadowPass& shadows,
                    const Light* lamp, bool reached);

    ShaderFamily tissue_, lit_at_vertices_, flat_;
};

}  // namespace eti::render
