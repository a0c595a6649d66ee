// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/mesh/patient_mesh.hpp"
#include "client/render/room/room_meshes.hpp"
#include "client/render/skin/breathing.hpp"
#include "client/render/skin/circulation.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// Behaviour of sync() while a new scene's colours are computed, which takes up to seconds.
enum class Baking : std::uint8_t {
    wait,
    in_background,  ///< nothing of the scene is drawn until they are ready
};

/// The scene's meshes, kept in sync with a SceneView.
class SceneMeshes {
  public:
    /// Rebuilds replaced objects and uploads changed state.
    void sync(const view::SceneView& scene, Baking baking);

    /// Whether there is a scene to draw.
    [[nodiscard]] bool ready() const { return ready_; }

    [[nodiscard]] PatientMesh& patient() { return patient_; }
    [[nodiscard]] const PatientMesh& patient() const { return patient_; }
    [[nodiscard]] const std::optional<GpuMesh>& blade() const { return blade_; }
    /// Parts of the laryngoscope that are only drawn.
    [[nodiscard]] const std::optional<GpuMesh>& blade_details() const { return blade_details_; }
    [[nodiscard]] const std::optional<GpuMesh>& bulb() const { return bulb_; }
    [[nodiscard]] const RoomMeshes& room() const { return room_; }
    [[nodiscard]] const std::optional<GpuMesh>& tube() const { return tube_; }
    /// In the frame of TubeSweep::connector_pose().
    [[nodiscard]] const std::optional<GpuMesh>& connector() const { return connector_; }
    [[nodiscard]] const Circulation& circulation() const { return circulation_; }

  private:
    using Appearances = std::map<std::string, SurfaceAppearance>;

    void rebuild(const view::SceneView& scene);
    void take_appearances(Baking baking);
    /// Follows the vital signs.
    void live(const view::SceneView& scene);

    std::uint64_t scene_revision_ = 0;
    bool ready_ = false;
    std::future<Appearances> baking_;
    PatientMesh patient_;
    std::optional<GpuMesh> blade_, blade_details_, bulb_;
    RoomMeshes room_;
    std::optional<GpuMesh> tube_, connector_;
    Circulation circulation_;
    Breathing breathing_;
};

}  // namespace eti::render
