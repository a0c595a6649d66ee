// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <functional>

#include "client/render/gl/gl_object.hpp"
#include "common/math/transform.hpp"

namespace eti::render {

/// Radiance by direction; linear, patient frame (-y is up).
using Radiance = std::function<Vec3f(const Vec3f&)>;

/// A delivery room around the table: luminaires in the ceiling, the warmer's lamp above, a window to the
/// patient's left, walls and floor.
[[nodiscard]] Vec3f room_radiance(const Vec3f& direction);

/// Irradiance / pi by surface normal as a quadratic polynomial of the normal n = (x, y, z), the projection of
/// a radiance onto spherical harmonics up to the second band, convolved with a cosine (Ramamoorthi & Hanrahan
/// 2001): c0 + c1 x + c2 y + c3 z + c4 xy + c5 yz + c6 zx + c7 (x^2 - y^2) + c8 (3 z^2 - 1). The error
/// against the exact irradiance of a distant sky is at most 9 % of its maximum and mostly below 3 %.
using Irradiance = std::array<Vec3f, 9>;

[[nodiscard]] Irradiance irradiance_of(const Radiance& radiance);
/// That of room_radiance() without the examination lamp, which is light 0 of a view.
[[nodiscard]] const Irradiance& room_irradiance();
[[nodiscard]] Vec3f evaluate(const Irradiance& irradiance, const Vec3f& normal);

/// Mean of the radiance that a surface of this roughness (Trowbridge-Reitz) mirrors towards a viewer along
/// `direction`, with the normal and the view along it too (Karis 2013), by `samples` directions.
[[nodiscard]] Vec3f prefiltered(const Radiance& radiance, const Vec3f& direction, float roughness,
                                int samples);

/// Cube map of room_radiance(); level k is prefiltered for roughness k / rough_level.
class EnvironmentMap {
  public:
    static constexpr int size = 32;  ///< texels per side of the sharpest level
    static constexpr float rough_level = 5.0f;

    EnvironmentMap();
    [[nodiscard]] const Texture& texture() const { return texture_; }

  private:
    Texture texture_;
};

}  // namespace eti::render
