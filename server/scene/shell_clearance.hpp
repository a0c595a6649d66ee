// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/scene/skeleton/wall_motion.hpp"

namespace eti::scene {

/// Inside tests of many points against a shell. A point is looked up only if it may have entered since its
/// last lookup. inside() may be called from any thread, for different points; begin() must not run meanwhile.
class ShellClearance {
  public:
    /// Prepares for `points` points and these walls; discards the cache of any others.
    void begin(std::size_t points, const Walls& walls) {
        if (last_.size() != points || revision_ != walls.revision) {
            last_.assign(points, {});
            revision_ = walls.revision;
        }
    }
    /// Whether the point is inside. Points may be queried in any order.
    [[nodiscard]] bool inside(std::size_t number, const Vec3f& point, const Walls& walls) {
        Place& last = last_[number];
        // Along each axis the grid's distance changes by at most the displacement, in total by sqrt(3) times
        // it; and the walls come nearer by at most their travel.
        const float room = last.distance - 2.0f * (walls.travel() - last.travel);
        if (room > 0.0f && 4.0f * (point - last.seen).squaredNorm() < room * room) {
            return false;
        }
        last = {point, walls.distance(point), walls.travel()};
        return last.distance < 0.0f;
    }

  private:
    struct Place {
        Vec3f seen = Vec3f::Zero();
        float distance = 0.0f;  // [m], at `seen`; 0: look up
        float travel = 0.0f;    // [m], of the walls until then
    };
    std::vector<Place> last_;  // [points]
    std::uint64_t revision_ = 0;
};

}  // namespace eti::scene
