// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <future>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"

namespace eti::scene {

/// The offset shell in the current posture: its mesh (for the rigid layer) at once, its distance grid
/// (for tube and tongue) a fixed number of steps later. The grid takes a second to compute, far longer
/// than a step; it is computed beside the simulation and taken over at a set step, whether it was ready
/// early or must be waited for, so that a session re-runs to the same bits.
class PosedShell {
  public:
    PosedShell(const anatomy::Patient& patient, const anatomy::BonePoses& bones);

    /// Moves the mesh. The distance grid follows `grid_delay` steps later; a further move meanwhile is
    /// picked up after that.
    void pose(const anatomy::BonePoses& bones);
    /// Moves mesh and grid, and waits for the grid where it has changed.
    void pose_now(const anatomy::BonePoses& bones);
    /// Once per step; takes over a finished grid.
    void advance();

    [[nodiscard]] const std::vector<Vec3f>& vertices() const { return vertices_; }
    [[nodiscard]] const DistanceGrid& distance() const { return distance_; }
    /// Changes whenever distance() does; never 0.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

    static constexpr int grid_delay = 180;  ///< steps; a second
    static constexpr float band = 4e-3f;    ///< [m], distances are exact within it

  private:
    void move(const anatomy::BonePoses& bones);
    void start();
    void take();

    const anatomy::Patient& patient_;
    std::vector<Vec3f> vertices_;
    DistanceGrid distance_;
    std::uint64_t revision_ = 0;
    std::future<DistanceGrid> pending_;
    int wait_ = 0;
    bool stale_ = false;
};

}  // namespace eti::scene
