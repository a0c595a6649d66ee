// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "client/view/revision.hpp"
#include "client/view/scene_object.hpp"
#include "common/math/transform.hpp"

namespace eti::view {

/// Position [m] and unit normal, as the graphics card takes them.
struct LitVertex {
    Vec3f position = Vec3f::Zero();
    Vec3f normal = Vec3f::UnitZ();
};

/// Area-weighted vertex normals from the current positions.
void recompute_normals(std::span<const Triangle> triangles, std::span<LitVertex> vertices);

/// A surface of the patient and its current shape.
class SkinnedSurface {
  public:
    explicit SkinnedSurface(RestSurface model);

    /// Reshapes what is carried by frames that have moved, bit for bit as if all were; true when there was
    /// any.
    bool update(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved);

    [[nodiscard]] const RestSurface& model() const { return *model_; }
    /// For work that goes on beside the surface and may outlive it.
    [[nodiscard]] std::shared_ptr<const RestSurface> shared_model() const { return model_; }
    [[nodiscard]] std::span<const LitVertex> vertices() const { return vertices_; }
    /// Another after each reshaping, so that a copy elsewhere knows whether it is current.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    void skin_moved(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved);
    void renew_normals();

    std::shared_ptr<const RestSurface> model_;  // which copies of the surface share
    std::vector<std::uint16_t> carriers_;       // the frames that carry any vertex
    std::vector<LitVertex> vertices_;
    std::vector<std::uint8_t> moved_;  // by vertex, in the last update
    std::vector<std::uint8_t> tilted_;
    std::uint64_t revision_ = next_revision();
};

}  // namespace eti::view
