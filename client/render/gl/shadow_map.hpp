// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <cstdint>

#include "client/render/gl/gl_object.hpp"
#include "client/render/lighting.hpp"

namespace eti::render {

/// Value outside the edges of a shadow map.
enum class OutsideShadowMap : std::uint8_t { lit, dark };

/// Depth map from a light's viewpoint.
class ShadowMap {
  public:
    ShadowMap(int size, OutsideShadowMap beyond);

    [[nodiscard]] int size() const { return size_; }

    /// Whether the map must be redrawn for this light matrix and scene state.
    [[nodiscard]] bool stale(const Eigen::Matrix4f& world_to_light, std::uint64_t state) const {
        return state_ != state || world_to_light_ != world_to_light;
    }
    /// Binds the map for drawing, cleared; bind another framebuffer afterwards.
    void begin(const Eigen::Matrix4f& world_to_light, std::uint64_t state);
    /// World-to-light matrix of the last drawing.
    [[nodiscard]] const Eigen::Matrix4f& world_to_light() const { return world_to_light_; }
    void bind_texture(GLenum unit) const;

  private:
    int size_;
    Framebuffer framebuffer_;
    Texture depth_;
    Eigen::Matrix4f world_to_light_ = Eigen::Matrix4f::Zero();
    std::uint64_t state_ = 0;
};

/// Orthographic view from a distant light, covering `radius` [m] around `centre`, as if its rays were
/// parallel.
[[nodiscard]] Eigen::Matrix4f directional_light_matrix(const Light& light, const Vec3f& centre, float radius);

/// Maps the world to the lamp's coordinates [m], z along its light.
[[nodiscard]] Eigen::Matrix4f world_to_lamp(const Light& lamp);

}  // namespace eti::render
