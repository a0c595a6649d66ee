// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/section_cut.hpp"

namespace eti::render {

/// The faces of a cut: each organ's contour in the plane, filled.
class CapsPass {
  public:
    CapsPass();
    void draw(const Drawing& drawing, const SceneMeshes& meshes);

  private:
    void draw_organ(const Drawing& drawing, const view::SkinnedSurface& organ,
                    const std::vector<VertexColour>& colours);

    ShaderProgram cut_, flat_;
    CutMesh mesh_;
};

}  // namespace eti::render
