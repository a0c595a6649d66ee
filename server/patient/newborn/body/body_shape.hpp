// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <mutex>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::patient {

/// Outline of a whole newborn, lying on the back with flexed limbs, closed lids and a closed mouth, in model
/// coordinates (x left, y anterior, z superior; millimetres of a 3.5 kg newborn) with a cranium of standard
/// size. Interpolates between 28 weeks and term.
class BodyShape {
  public:
    /// `gestational_age` [weeks].
    explicit BodyShape(float gestational_age);

    /// Whether the program was built with a body's data.
    [[nodiscard]] static bool is_available();

    /// Signed distance [mm], negative inside; beyond 60 mm constant. May be called from several threads. The
    /// first call takes about a second.
    [[nodiscard]] float distance(const Vec3f& point) const;

    /// Edge length [mm] that resolves the surface at a point: that of the data, which is fine at lids, ears,
    /// fingers and toes. Changes by at most a quarter of the distance.
    [[nodiscard]] float detail(const Vec3f& point) const;

    /// The data's surface [mm], closed and oriented outwards.
    [[nodiscard]] const TriangleMesh& surface() const { return mesh_; }

    /// Corners [mm] of the bounding box.
    [[nodiscard]] const std::array<Vec3f, 2>& bounds() const { return bounds_; }

  private:
    void build_grids() const;
    void build_detail() const;

    TriangleMesh mesh_;
    std::array<Vec3f, 2> bounds_;
    // Distances are limited to a few spacings; beyond, the next grid answers.
    mutable std::vector<DistanceGrid> grids_;  // of head, hands and feet, and of the whole body
    mutable DistanceGrid surroundings_;
    mutable DistanceGrid detail_;  // of edge lengths [mm]
    mutable std::once_flag built_;
};

}  // namespace eti::patient
