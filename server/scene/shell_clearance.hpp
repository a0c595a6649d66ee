// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"

namespace eti::scene {

/// Inside tests of many points against a shell. A point is looked up only if it may have entered since its
/// last lookup. inside() may be called from any thread, for different points; begin() must not run meanwhile.
class ShellClearance {
  public:
    /// Prepares for `points` points and the shell with this revision; discards the cache of any other.
    void begin(std::size_t points, std::uint64_t revision) {
        if (last_.size() != points || revision_ != revision) {
            last_.assign(points, {});
            revision_ = revision;
        }
    }
    /// Whether the point is inside. Points may be queried in any order.
    [[nodiscard]] bool inside(std::size_t number, const Vec3f& point, const DistanceGrid& shell) {
        Place& last = last_[number];
        // Along each axis the grid's distance changes by at most the displacement, in total by sqrt(3) times
        // it.
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
        float distance = 0.0f;  // [m], at `seen`; 0: look up
    };
    std::vector<Place> last_;  // [points]
    std::uint64_t revision_ = 0;
};

}  // namespace eti::scene
