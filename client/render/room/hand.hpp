// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "client/render/room/solid.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::render {

/// What a gloved hand holds, and how.
enum class Grip : std::uint8_t {
    handle,  ///< the left hand around the laryngoscope's handle, thumb up; frame of the laryngoscope
    tube,    ///< the right hand's pinch of the tube between thumb and two fingers; see tube_grip()
    larynx,  ///< an assistant's right hand at the neck, thumb and two fingers beside the larynx; see
             ///< larynx_grip()
};
inline constexpr std::size_t grip_count = 3;

/// Signed distance [m] of a gloved hand in the frame of its grip: capsules of an adult's
/// phalanges and metacarpals, blended within a finger and into the palm.
[[nodiscard]] float hand_distance(Grip grip, const Vec3f& point);

/// The hand's closed surface, of about `triangles` triangles, and a sleeve. Takes some tenths of a second.
[[nodiscard]] Solid gloved_hand(Grip grip, std::size_t triangles);

/// Frame of the hand that holds the tube, `from_tip` [m] along the tube's `nodes` [m], which run from the
/// connector to the tip: z along the tube towards its tip, y towards the wrist, on the operator's right;
/// nullopt without a tube.
[[nodiscard]] std::optional<RigidTransform> tube_grip(std::span<const Vec3f> nodes, float from_tip);

/// Frame of an assistant's hand that presses the larynx from outside: origin on the skin in front of it, at
/// `skin` [m], x towards the patient's left, y towards the wrist, left of the patient and out of the
/// operator's way.
[[nodiscard]] RigidTransform larynx_grip(const Vec3f& skin);

}  // namespace eti::render
