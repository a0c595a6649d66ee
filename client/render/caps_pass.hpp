// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"

namespace eti::render {

/// The faces of a cut: what lies inside an organ's contour in the plane, filled. The contour is found on the
/// graphics card among the triangles that the plane may cut; nothing is sent for it.
class CapsPass {
  public:
    CapsPass();
    void draw(const Drawing& drawing, SceneMeshes& meshes);

  private:
    void make_grain();
    void draw_organ(const Drawing& drawing, PatientMesh& patient, std::size_t part);

    ShaderProgram fan_, band_, face_, flat_face_;
    VertexArray no_attributes_;
    Texture grain_;  // of the fibres
};

}  // namespace eti::render
