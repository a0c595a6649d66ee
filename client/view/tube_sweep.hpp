// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/revision.hpp"
#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::view {

struct TubeVertex {
    Vec3f position = Vec3f::Zero();  ///< [m]
    Vec3f normal = Vec3f::UnitZ();
    float from_tip = 0.0f;  ///< [m] along the centre line; on the connector more than the tube's length
    float around = 0.0f;    ///< turns from the concave side, 0-1, towards the patient's left
};

/// The tube's surface: outer and inner wall swept along the centre line, closed, with a bevelled opening at
/// the tip. The bevel faces left when the concave side lies anterior, as on a Magill tip. The connector is a
/// rigid mesh of its own.
class TubeSweep {
  public:
    static constexpr int rings = 52;  ///< along each wall
    static constexpr int sides = 24;  ///< around

    explicit TubeSweep(const Tube& tube);

    /// Sweeps along `nodes` [m], connector to tip; fewer than two distinct nodes change nothing.
    bool update(std::span<const Vec3f> nodes);

    [[nodiscard]] const Tube& tube() const { return tube_; }
    [[nodiscard]] std::span<const TubeVertex> vertices() const { return vertices_; }
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
    /// Frame of the connector: origin at the tube's end, z along the tube towards its tip, x the concave
    /// side.
    [[nodiscard]] const RigidTransform& connector_pose() const { return connector_pose_; }
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    Tube tube_;
    std::vector<TubeVertex> vertices_;
    std::vector<Triangle> triangles_;
    RigidTransform connector_pose_;
    std::uint64_t revision_ = 0;  ///< 0: no nodes received yet
};

}  // namespace eti::view
