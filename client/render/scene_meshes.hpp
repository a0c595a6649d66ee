// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/render/gpu_mesh.hpp"
#include "client/render/triangle_blocks.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// One of the patient's surfaces on the graphics card.
struct SurfaceMesh {
    std::string name;
    Tissue tissue = Tissue::soft;
    bool bone = false;  ///< hidden inside the body, unless that is cut open
    std::vector<VertexColour> colours;
    GpuMesh mesh;
    TriangleBlocks blocks;
};

/// The scene's meshes, kept in step with a SceneView.
class SceneMeshes {
  public:
    /// Rebuilds what was replaced and uploads what moved.
    void sync(const view::SceneView& scene);

    /// Outermost first, so that in a section the organs lie over the body around them.
    [[nodiscard]] std::vector<SurfaceMesh>& surfaces() { return surfaces_; }
    [[nodiscard]] const std::optional<GpuMesh>& blade() const { return blade_; }
    [[nodiscard]] const std::optional<GpuMesh>& tube() const { return tube_; }

  private:
    void rebuild(const view::SceneView& scene);

    std::uint64_t scene_revision_ = 0;
    std::vector<SurfaceMesh> surfaces_;
    std::optional<GpuMesh> blade_;
    std::optional<GpuMesh> tube_;
};

}  // namespace eti::render
