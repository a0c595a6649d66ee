// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/pbd/soft/tetrahedra.hpp"

namespace eti::bench {

/// A tetrahedral mesh of stable neo-Hookean material in XPBD (Macklin & Müller 2021), a reference for the
/// implicit method with the same elements.
///
/// One pass per substep makes statics too soft, by 0.05 to 0.4 of (dt c / h)^2, with the speed of pressure
/// waves c = sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) density)) and the edge length h: half the substep gives a
/// quarter of the error. Cells of 2.5 mm of 5 kPa and nu = 0.45: 11 % at 1/1500 s, 3 % at 1/3000 s. Stable
/// with E dt^2 / (density h^2) up to 0.8; at 1.5 no disturbed block recovered (docs/solver/stability.md).
class XpbdTetrahedra {
  public:
    void configure(const pbd::Tetrahedra::Description& description, const pbd::Particles& particles);
    /// One Gauss-Seidel pass: moves the free particles' predicted positions. Substep `dt` [s].
    void project(pbd::Particles& particles, float dt);

  private:
    pbd::Tetrahedra mesh_;
    float ratio_ = 1.0f;  // mu / lambda
    // [corners], then padding for the last block of each colour: predicted position and inverse mass.
    std::vector<Eigen::Vector4f> wide_;
};

}  // namespace eti::bench
