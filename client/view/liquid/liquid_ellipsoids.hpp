// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include <span>
#include <vector>

#include "client/view/liquid/spatial_hash.hpp"

namespace eti::view {

/// The shape that stands for a particle: smoothed centre, semi-axes and their directions.
struct LiquidEllipsoid {
    Vec3f centre = Vec3f::Zero();        ///< [m]
    Vec3f radii = Vec3f::Zero();         ///< [m], ascending
    Quatf rotation = Quatf::Identity();  ///< from the semi-axes to the patient frame

    [[nodiscard]] float volume() const;  ///< [m^3]
};

/// Anisotropic kernels (Yu & Turk 2013, ACM TOG 32:5): each particle becomes an ellipsoid along the principal
/// axes of its neighbours' weighted covariance, about a centre that is moved towards their mean. A film or
/// the surface of a pool becomes flat, bulk liquid stays round, and a separate drop is a sphere of a
/// particle's volume. Not modelled: constant volume of the union.
class LiquidEllipsoids {
  public:
    /// Bounds of a semi-axis among neighbours, in spacings.
    static constexpr float thinnest = 0.35f, widest = 1.25f;
    /// Radius in spacings of a sphere as large as a particle, a cube of its spacing.
    static constexpr float alone = 0.62f;

    void fit(std::span<const Vec3f> positions, float spacing);  ///< [m]

    /// By particle.
    [[nodiscard]] std::span<const LiquidEllipsoid> ellipsoids() const { return ellipsoids_; }

  private:
    SpatialHash cells_;
    std::vector<LiquidEllipsoid> ellipsoids_;
};

}  // namespace eti::view
