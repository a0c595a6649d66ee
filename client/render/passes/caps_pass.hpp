// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/draw_context.hpp"
#include "client/render/mesh/scene_meshes.hpp"

namespace eti::render {

/// The faces of a section: the interior of each organ's contour in the plane, filled. The contour is
/// computed on the GPU from the triangles that the plane may intersect; nothing is uploaded for it. GL state:
/// begin_passes(); needs a stencil buffer of zeros and leaves zeros. Its faces replace what was drawn before,
/// at any depth: run it before the tools, which alone lie in front of the plane.
class CapsPass {
  public:
    CapsPass();
    void draw(const DrawContext& context, SceneMeshes& meshes);

  private:
    void make_grain();
    void draw_organ(const DrawContext& context, PatientMesh& patient, std::size_t part);

    ShaderProgram fan_, band_, face_, flat_face_;
    VertexArray no_attributes_;
    Texture grain_;  // noise for the fibre pattern
};

}  // namespace eti::render
