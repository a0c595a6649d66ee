// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/math/transform.hpp"

namespace eti::render {

/// How visibly blue skin and mucosa are, 0-1, at an oxygen saturation [%]: 0 from 90 % upwards, 1 at 60 % and
/// below. Observers of newborns at delivery called them pink at 69 % on average, with wide scatter (O'Donnell
/// et al. 2007, Arch Dis Child Fetal Neonatal Ed 92:F465).
[[nodiscard]] float cyanosis(double saturation_percent);

/// What a newborn's blood does to the colour of the skin. Not modelled: acrocyanosis of a healthy newborn,
/// mottling, jaundice.
class Circulation {
  public:
    /// Follows the patient monitor, in simulation time; nullopt: not simulated, and the colour is a healthy
    /// newborn's. Starts anew where time goes back.
    void update(double time_s, std::optional<double> saturation_percent,
                std::optional<double> heart_rate_per_min);

    /// For `circulation` of shaders/tissue/blood.glsl, each 0-1: cyanosis of trunk, lips and mucosa; of hands
    /// and feet, which follow later; pallor.
    [[nodiscard]] Vec3f colouring() const;

  private:
    std::optional<double> time_s_;
    double central_ = 100.0, peripheral_ = 100.0;  // [%], oxygen saturation
    double heart_rate_ = 140.0;                    // [1/min]
};

}  // namespace eti::render
