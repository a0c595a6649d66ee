// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/render/room/solid.hpp"

namespace eti::render {

/// The rigid part of a delivery room. Its origin lies at the mattress's surface, in the midline of the edge
/// at which the operator stands; axes are those of the patient frame: x to the patient's left, y down, z
/// towards the operator.
struct Furniture {
    std::vector<Solid>
        dull;       ///< everything lit, in parts that are culled one by one; the last: floor and walls
    Solid glowing;  ///< the warmer's element and the luminaires
    Vec3f screen_centre = Vec3f::Zero();                                ///< of the monitor
    Vec3f screen_right = Vec3f::UnitX(), screen_down = Vec3f::UnitY();  ///< [m], half its sides
};

/// `blade`: the laryngoscope's mesh in its own frame, for the spare one on the tray; may be empty.
[[nodiscard]] Furniture make_furniture(const Solid& blade);

}  // namespace eti::render
