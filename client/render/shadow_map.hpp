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

    /// Whether it must be drawn anew for this light and this state of the scene.
    [[nodiscard]] bool stale(const Eigen::Matrix4f& clip, std::uint64_t state) const {
        return state_ != state || clip_ != clip;
    }
    /// Binds the map for drawing, cleared; bind another framebuffer afterwards.
    void begin(const Eigen::Matrix4f& clip, std::uint64_t state);
    /// World to clip coordinates of what was last drawn into it.
    [[nodiscard]] const Eigen::Matrix4f& clip() const { return clip_; }
    /// World to map coordinates 0-1 (homogeneous).
    [[nodiscard]] Eigen::Matrix4f lookup() const;
    void bind_texture(GLenum unit) const;

  private:
    int size_;
    Framebuffer framebuffer_;
    Texture depth_;
    Eigen::Matrix4f clip_ = Eigen::Matrix4f::Zero();
    std::uint64_t state_ = 0;
};

/// From a light far away over `radius` [m] around `centre`, as if its rays were parallel.
[[nodiscard]] Eigen::Matrix4f parallel_clip(const Light& light, const Vec3f& centre, float radius);

/// From a lamp into its cone, as far as `reach` [m].
[[nodiscard]] Eigen::Matrix4f cone_clip(const Light& lamp, float reach);

}  // namespace eti::render
