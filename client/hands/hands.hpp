// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <set>
#include <span>
#include <string_view>

#include "client/hands/drag.hpp"
#include "client/hands/held_tool.hpp"
#include "client/render/camera.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools.hpp"

namespace eti::client {

/// One row of the table of keys that move the hand while they are held.
struct HandKey {
    char32_t key;
    std::string_view caption;  ///< of the key, in ASCII
    std::string_view help;
    float lift = 0.0f;           ///< [m/s]
    Vec3f turn = Vec3f::Zero();  ///< [rad/s], about the tool's axes
};

[[nodiscard]] std::span<const HandKey> hand_keys();

/// Tab and `z`: the other hand takes over; the hand goes back to its start.
inline constexpr char32_t other_hand_key = U'\t', home_key = U'z';

[[nodiscard]] bool is_hand_key(char32_t key);

/// Where a hand begins: before the open mouth, on the way in. The blade at its right corner, the tube beside.
[[nodiscard]] RigidTransform hand_start(Tool tool, const Landmarks& now, const Laryngoscope& scope,
                                        const Tube& tube);

/// What the mouse did in a picture.
struct HandDrag {
    Drag mouse;
    render::Camera camera;
    float height = 1.0f;  ///< [pixels], of the picture
};

/// Two hands, of which mouse and keys move one at a time: input in, poses out. Knows neither window nor bus.
///
/// The left button takes hold and moves what is held in the picture's plane, so that the tip stays beneath
/// the pointer; let go, and all stays where it is. A tube that is in the mouth is turned about the lips
/// instead, as fingers do it. The right button swings the hand about the tip. The wheel slides the tool.
class Hands {
  public:
    Hands(const Laryngoscope& scope, const Tube& tube, const Landmarks& now);

    /// True: the key is one of the hands'.
    bool press(char32_t key);
    void release(char32_t key);
    void drag(const HandDrag& drag, const Landmarks& now);
    /// Lets `dt` [s] pass.
    void advance(float dt, const Lead& blade, const Lead& tube);

    void choose(Tool tool) { chosen_ = tool; }
    [[nodiscard]] Tool chosen() const { return chosen_; }
    [[nodiscard]] const HeldTool& held(Tool tool) const { return tools_[static_cast<std::size_t>(tool)]; }

  private:
    [[nodiscard]] HeldTool& held_now() { return tools_[static_cast<std::size_t>(chosen_)]; }

    std::array<HeldTool, 2> tools_;  // by Tool
    Tool chosen_ = Tool::laryngoscope;
    std::set<char32_t> pressed_;
};

}  // namespace eti::client
