// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/render/gpu_mesh.hpp"
#include "client/render/patient_mesh.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// What sync() does while a new scene's colours are computed, which takes up to seconds.
enum class Baking : std::uint8_t {
    wait,
    go_on,  ///< nothing of the scene is drawn meanwhile
};

/// The scene's meshes, kept in step with a SceneView.
class SceneMeshes {
  public:
    /// Rebuilds what was replaced and sends what moved.
    void sync(const view::SceneView& scene, Baking baking);

    /// Whether there is a scene to draw.
    [[nodiscard]] bool ready() const { return ready_; }

    [[nodiscard]] PatientMesh& patient() { return patient_; }
    [[nodiscard]] const PatientMesh& patient() const { return patient_; }
    /// Of a surface's vertices; bones have them too.
    [[nodiscard]] const std::vector<VertexColour>& colours(const std::string& surface) const {
        return colours_.at(surface);
    }
    [[nodiscard]] const std::optional<GpuMesh>& blade() const { return blade_; }
    [[nodiscard]] const std::optional<GpuMesh>& tube() const { return tube_; }

  private:
    using Colours = std::map<std::string, std::vector<VertexColour>>;

    void rebuild(const view::SceneView& scene);
    void take_colours(Baking baking);

    std::uint64_t scene_revision_ = 0;
    bool ready_ = false;
    std::future<Colours> baking_;
    PatientMesh patient_;
    Colours colours_;
    std::optional<GpuMesh> blade_;
    std::optional<GpuMesh> tube_;
};

}  // namespace eti::render
