// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"

namespace eti::scene {

/// Which of many points are inside a shell, looked up only where a point may have come there since.
class ShellClearance {
  public:
    /// Of so many points, and of the shell that has this revision; forgets what was of another.
    void begin(std::size_t points, std::uint64_t revision) {
        if (last_.size() != points || revision_ != revision) {
            last_.assign(points, {});
            revision_ = revision;
        }
    }
    /// Whether the point is inside. Points may be asked for in any order, and beside each other.
    [[nodiscard]] bool inside(std::size_t number, const Vec3f& point, const DistanceGrid& shell) {
        Place& last = last_[number];
        // Along each axis the grid's distance changes by no more than the way, in all by sqrt(3) of it.
        if (last.distance > 0.0f &&
            4.0f * (point - last.seen).squaredNorm() < last.distance * last.distance) {
            return false;
        }
        last = {point, shell.distance(point)};
        return last.distance < 0.0f;
    }

  private:
    struct Place {
        Vec3f seen = Vec3f::Zero();
        float distance = 0.0f;  // [m], there; 0: look again
    };
    std::vector<Place> last_;
    std::uint64_t revision_ = 0;
};

}  // namespace eti::scene
