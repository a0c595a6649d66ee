// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/gl_object.hpp"
#include "client/render/lighting.hpp"

namespace eti::render {

/// Depths as the key light sees them, around a point.
class ShadowMap {
  public:
    ShadowMap();

    /// World to map coordinates 0-1 for a light; the map covers `radius` [m] around `centre`.
    [[nodiscard]] static Eigen::Matrix4f matrix(const Light& light, const Vec3f& centre, float radius);
    /// World to clip coordinates while drawing into the map.
    [[nodiscard]] static Eigen::Matrix4f clip_matrix(const Light& light, const Vec3f& centre, float radius);

    /// Binds the map for drawing, cleared; bind another framebuffer afterwards.
    void begin() const;
    void bind_texture() const { glBindTexture(GL_TEXTURE_2D, depth_.name()); }

  private:
    Framebuffer framebuffer_;
    Texture depth_;
};

}  // namespace eti::render
