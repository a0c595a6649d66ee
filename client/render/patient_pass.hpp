// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/render/drawing.hpp"
#include "client/render/finer_drawing.hpp"
#include "client/render/patient_outlines.hpp"
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
                                         bool filmed, bool finer);
    /// Ready to draw with.
    ShaderProgram& begin(const Drawing& drawing, const PatientMesh& patient, const ShadowPass& shadows,
                         bool lamplit, bool finer);
    /// Everything, or with a lamp what it reaches or does not; but for what is drawn finer.
    void draw_parts(const Drawing& drawing, const PatientMesh& patient, const ShadowPass& shadows,
                    const Light* lamp, bool reached);
    /// What was left of that. All of it by one program: two would round a common edge's places otherwise, and
    /// leave gaps of a pixel.
    void draw_finer(const Drawing& drawing, const PatientMesh& patient, const ShadowPass& shadows);

    PatientOutlines outlines_;
    FinerDrawing finer_;
    std::vector<std::vector<FinerInstance>> left_;  // by part
    ShaderFamily tissue_, lit_at_vertices_, flat_;
};

}  // namespace eti::render
