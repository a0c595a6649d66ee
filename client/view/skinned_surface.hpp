// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "client/view/revision.hpp"
#include "common/bus/codec/scene_object.hpp"
#include "common/math/transform.hpp"

namespace eti::view {

/// Position [m] and unit normal, in GPU layout.
struct LitVertex {
    Vec3f position = Vec3f::Zero();
    Vec3f normal = Vec3f::UnitZ();
};

/// Recomputes area-weighted vertex normals from the current positions.
void recompute_normals(std::span<const Triangle> triangles, std::span<LitVertex> vertices);

/// A surface of the patient and its current shape.
class SkinnedSurface {
  public:
    explicit SkinnedSurface(bus::RestSurface model);

    /// Re-skins the vertices of frames that have moved, bitwise identical to a full update; true if there
    /// were any.
    bool update(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved);

    [[nodiscard]] const bus::RestSurface& model() const { return *model_; }
    /// For background work that may outlive the surface.
    [[nodiscard]] std::shared_ptr<const bus::RestSurface> shared_model() const { return model_; }
    [[nodiscard]] std::span<const LitVertex> vertices() const { return vertices_; }
    /// Revision counter; changes with each re-skinning, so that copies can detect changes.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    void skin_moved(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved);
    void update_normals();

    std::shared_ptr<const bus::RestSurface> model_;  // shared by copies of the surface
    std::vector<std::uint16_t> used_frames_;         // frames that influence any vertex
    std::vector<LitVertex> vertices_;
    std::vector<std::uint8_t> moved_;  // by vertex, in the last update
    std::vector<std::uint8_t> tilted_;
    std::uint64_t revision_ = next_revision();
};

}  // namespace eti::view
