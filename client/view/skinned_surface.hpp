// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/scene_object.hpp"
#include "common/math/transform.hpp"

namespace eti::view {

/// Position [m] and unit normal, as the graphics card takes them.
struct LitVertex {
    Vec3f position = Vec3f::Zero();
    Vec3f normal = Vec3f::UnitZ();
};

/// Linear blend skinning of all of a surface's vertices; `vertices` has one per rest vertex.
void skin_vertices(const SurfaceModel& model, std::span<const FrameMap> frames,
                   std::span<LitVertex> vertices);

/// Area-weighted vertex normals from the current positions.
void recompute_normals(std::span<const Triangle> triangles, std::span<LitVertex> vertices);

/// A surface of the patient and its current shape.
class SkinnedSurface {
  public:
    explicit SkinnedSurface(SurfaceModel model);

    /// Reshapes the surface when a frame that carries it has moved; true when it did.
    bool update(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved);

    [[nodiscard]] const SurfaceModel& model() const { return model_; }
    [[nodiscard]] std::span<const LitVertex> vertices() const { return vertices_; }
    /// Counts reshapings, so that a copy elsewhere knows whether it is current.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    SurfaceModel model_;
    std::vector<std::uint16_t> carriers_;  ///< the frames that carry any vertex
    std::vector<LitVertex> vertices_;
    std::uint64_t revision_ = 1;
};

}  // namespace eti::view
