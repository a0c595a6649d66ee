// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "client/render/draw_context.hpp"
#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/render/mesh/patient_outlines.hpp"
#include "client/render/mesh/scene_meshes.hpp"
#include "client/render/passes/shadow_pass.hpp"
#include "client/render/passes/tessellation_renderer.hpp"

namespace eti::render {

/// The patient's surfaces: skin, mucosa, cords. GL state: begin_passes(); samples the maps of the last
/// ShadowPass::draw().
class PatientPass {
  public:
    PatientPass();
    void draw(const DrawContext& context, SceneMeshes& meshes, const ShadowPass& shadows);

  private:
    [[nodiscard]] ShaderProgram& program(const DrawContext& context, const ShadowPass& shadows, bool lamplit,
                                         bool filmed, bool finer);
    /// Sets up a program for drawing.
    ShaderProgram& begin(const DrawContext& context, const PatientMesh& patient, const ShadowPass& shadows,
                         bool lamplit, bool finer);
    /// Draws everything, or with a lamp only what it reaches or does not, and defers tessellated triangles.
    void draw_parts(const DrawContext& context, const PatientMesh& patient, const ShadowPass& shadows,
                    const Light* lamp, bool reached);
    /// Draws the deferred triangles. One program draws them all: two would round the positions on a shared
    /// edge differently and leave one-pixel gaps.
    void draw_finer(const DrawContext& context, const PatientMesh& patient, const ShadowPass& shadows);

    /// Binds the pattern of mucosa, which is made when first needed.
    void bind_mucosa();
    /// The same of hair.
    void bind_hair();

    PatientOutlines outlines_;
    TessellationRenderer finer_;
    std::vector<std::vector<TessellatedInstance>> deferred_;  // by part
    ShaderVariants tissue_, lit_at_vertices_, flat_;
    std::optional<Texture> mucosa_,
        hair_;  // MucosaPattern and HairPattern, once a quality with fine relief draws
    Vec3f circulation_ = Vec3f::Zero();  // Circulation::colouring() of the scene being drawn
};

}  // namespace eti::render
