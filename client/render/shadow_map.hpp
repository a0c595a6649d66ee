// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <cstdint>

#include "client/render/gl_object.hpp"
#include "client/render/lighting.hpp"

namespace eti::render {

/// What lies beyond the edges of a shadow map.
enum class Beyond : std::uint8_t { lit, dark };

/// Depths as a light sees them.
class ShadowMap {
  public:
    ShadowMap(int size, Beyond beyond);

    [[nodiscard]] int size() const { return size_; }

    /// Whether it must be drawn anew for this light's matrix and this state of the scene.
    [[nodiscard]] bool stale(const Eigen::Matrix4f& into_light, std::uint64_t state) const {
        return state_ != state || into_light_ != into_light;
    }
    /// Binds the map for drawing, cleared; bind another framebuffer afterwards.
    void begin(const Eigen::Matrix4f& into_light, std::uint64_t state);
    /// From the world, as it was last drawn.
    [[nodiscard]] const Eigen::Matrix4f& into_light() const { return into_light_; }
    void bind_texture(GLenum unit) const;

  private:
    int size_;
    Framebuffer framebuffer_;
    Texture depth_;
    Eigen::Matrix4f into_light_ = Eigen::Matrix4f::Zero();
    std::uint64_t state_ = 0;
};

/// From a light far away over `radius` [m] around `centre`, as if its rays were parallel.
[[nodiscard]] Eigen::Matrix4f parallel_clip(const Light& light, const Vec3f& centre, float radius);

/// Into a lamp's own coordinates [m], the third along its light.
[[nodiscard]] Eigen::Matrix4f into_lamp(const Light& lamp);

}  // namespace eti::render
