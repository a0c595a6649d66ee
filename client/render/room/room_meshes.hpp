// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/room/bedding_mesh.hpp"
#include "client/render/room/hand.hpp"
#include "client/render/room/pulse_traces.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// The meshes of the room around the patient, kept in sync with a SceneView: bedding that follows the body,
/// furniture, a monitor, and gloved hands on the tools.
class RoomMeshes {
  public:
    /// Rebuilds for a new scene; `blade`: the laryngoscope's mesh, for the spare one.
    void build(const view::SceneView& scene, const Solid& blade);
    /// Follows the scene's posture, tools and vital signs; waits for the hands' shapes on first use.
    void sync(const view::SceneView& scene);

    /// A rigid part with its bounding sphere.
    struct Part {
        GpuMesh mesh;
        Vec3f centre;
        float radius;
        bool near;  ///< on or beside the table
    };
    [[nodiscard]] const std::optional<BeddingMesh>& bedding() const { return bedding_mesh_; }
    [[nodiscard]] std::span<const Part> furniture() const { return furniture_; }
    [[nodiscard]] const std::optional<GpuMesh>& glowing() const { return glowing_; }
    struct Screen {
        GpuMesh mesh;
        Vec3f centre;
        float radius;
    };
    [[nodiscard]] const std::optional<Screen>& screen() const { return screen_; }
    /// Pose of furniture, glow and screen.
    [[nodiscard]] const RigidTransform& pose() const { return pose_; }
    [[nodiscard]] const PulseTraces& traces() const { return traces_; }

    struct Hand {
        const GpuMesh* fine = nullptr;
        const GpuMesh* coarse = nullptr;  ///< with fewer triangles
        RigidTransform pose;
    };
    /// The hands on tools that are in use, and an assistant's while the larynx is pressed from outside.
    [[nodiscard]] std::span<const Hand> hands() const { return hands_; }

    /// Shape of the bedding, for tests.
    [[nodiscard]] const std::optional<Bedding>& bedding_shape() const { return bedding_; }

  private:
    void rest(const view::SceneView& scene);
    void hold(const view::SceneView& scene);
    void find_larynx(const view::SceneView& scene);

    BodyOutline outline_;
    std::vector<Vec3f> shaped_for_;  ///< outline's points when the bedding was last shaped
    std::optional<Bedding> bedding_;
    std::optional<BeddingMesh> bedding_mesh_;
    std::vector<Part> furniture_;
    std::optional<GpuMesh> glowing_;
    std::optional<Screen> screen_;
    struct HandMeshes {
        GpuMesh fine, coarse;
    };
    std::array<std::optional<HandMeshes>, grip_count> hand_meshes_;  ///< by Grip
    std::vector<Hand> hands_;
    /// Skin in front of the larynx, at rest [m]; nullopt on a patient without.
    struct SkinPoint {
        Vec3f rest;
        SkinWeights skin;
    };
    std::optional<SkinPoint> over_larynx_;
    RigidTransform pose_;
    PulseTraces traces_;
};

}  // namespace eti::render
