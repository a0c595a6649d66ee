// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <future>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/scene/skeleton/wall_motion.hpp"

namespace eti::scene {

/// The offset shell in the current posture: its mesh (for the rigid layer) at once, its distance grid (for
/// tube and tongue) a fixed number of steps later. The grid takes about a second to compute, far longer than
/// a step. It is computed in the background and adopted at a fixed step, early or late, so that a replayed
/// session is bit-identical. Where bones yield, a field of displacements moves its walls at once. The physics
/// thread calls all functions; distance() and walls() do not change outside pose_now(), advance() and
/// yield(), so that others may read them during a step.
class PosedShell {
  public:
    /// Has no shape before pose_now(). `skeleton`: which yields, and outlives this; nullptr: none. Its
    /// posture is that of the bones that are given then.
    PosedShell(const patient::Patient& patient, const YieldingSkeleton* skeleton);
    /// As above, followed by pose_now().
    PosedShell(const patient::Patient& patient, const patient::BonePoses& bones,
               const YieldingSkeleton* skeleton = nullptr);

    /// Moves the mesh. The distance grid follows `grid_delay` steps later; a move in between is picked up
    /// after that.
    void pose(const patient::BonePoses& bones);
    /// Moves mesh and grid, and waits for the grid if it has changed.
    void pose_now(const patient::BonePoses& bones);
    /// Call once per step; adopts a finished grid.
    void advance();
    /// Moves mesh and walls with the yielding skeleton.
    void yield();

    [[nodiscard]] const std::vector<Vec3f>& vertices() const { return vertices_; }
    [[nodiscard]] const DistanceGrid& distance() const { return distance_; }
    /// Changes whenever distance() does; 0 before pose_now().
    [[nodiscard]] std::uint64_t revision() const { return revision_; }
    [[nodiscard]] Walls walls() const {
        return {distance_, revision_, skeleton_ == nullptr ? nullptr : &motion_};
    }
    /// What carries a triangle.
    [[nodiscard]] YieldingSkeleton::Carrier carrier_of(std::uint32_t triangle) const;

    static constexpr int grid_delay = 180;  ///< [steps]; one second
    static constexpr float band = 4e-3f;    ///< [m]; distances are exact within this band

  private:
    struct Posed {
        DistanceGrid distance;
        WallMotion motion;
    };
    void move(const patient::BonePoses& bones);
    void update_walls();
    void start();
    void take();

    const patient::Patient& patient_;
    std::vector<Vec3f> vertices_;  // [shell vertices][m]
    const YieldingSkeleton* skeleton_;
    std::vector<YieldingSkeleton::Carrier> carriers_;  // [shell vertices], of a skeleton that yields
    DistanceGrid distance_;
    WallMotion motion_;
    std::uint64_t revision_ = 0;
    std::future<Posed> pending_;
    int wait_ = 0;
    bool stale_ = false;
};

}  // namespace eti::scene
