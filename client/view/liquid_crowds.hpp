// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "client/view/liquid_cells.hpp"

namespace eti::view {

/// Tells drops from liquid: how crowded each particle of a state is.
class LiquidCrowds {
  public:
    void count(std::span<const Vec3f> positions, float spacing);  ///< [m]

    /// Of each particle about the number of those a `spacing` away; those farther count less, up to one and
    /// a half of it, so that nothing jumps.
    [[nodiscard]] std::span<const float> crowds() const { return crowds_; }

  private:
    LiquidCells cells_;
    std::vector<float> crowds_;
};

}  // namespace eti::view
