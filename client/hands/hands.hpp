// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <set>

#include "client/hands/drag.hpp"
#include "client/render/views/camera.hpp"
#include "common/device/held_tool.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::hands {

/// Tab switches to the other hand.
inline constexpr char32_t other_hand_key = U'\t';

/// A row of hand_keys(), home_key or other_hand_key.
[[nodiscard]] bool is_hand_key(char32_t key);

/// Start pose of a tool: in front of the open mouth, on the insertion path. The blade is at the right
/// corner, the tube beside it.
[[nodiscard]] RigidTransform hand_start(Tool tool, const Landmarks& now, const Laryngoscope& scope,
                                        const Tube& tube);

/// A mouse drag in a picture.
struct HandDrag {
    Drag mouse;
    render::Camera camera;
    float height = 1.0f;  ///< [pixels], of the picture
};

/// Two hands, one of which is moved by mouse and keys at a time: input in, poses out. Independent of window
/// and bus.
///
/// The left button grabs the tool and moves it in the picture plane, so that the tip stays under the
/// pointer; on release everything stays in place. A tube in the mouth pivots about the lips instead, as
/// fingers would move it. The right button swings the hand about the tip. The wheel slides the tool along
/// its axis.
class Hands {
  public:
    Hands(const Laryngoscope& scope, const Tube& tube, const Landmarks& now);

    /// Returns true if the key is a hand key.
    bool press(char32_t key);
    void release(char32_t key);
    void drag(const HandDrag& drag, const Landmarks& now);
    /// Advances by `dt` [s].
    void advance(float dt, const Overtravel& blade, const Overtravel& tube);

    void choose(Tool tool) { chosen_ = tool; }
    [[nodiscard]] Tool chosen() const { return chosen_; }
    [[nodiscard]] const HeldTool& held(Tool tool) const { return tools_[static_cast<std::size_t>(tool)]; }

  private:
    [[nodiscard]] HeldTool& active_tool() { return tools_[static_cast<std::size_t>(chosen_)]; }

    std::array<HeldTool, 2> tools_;  // by Tool
    Tool chosen_ = Tool::laryngoscope;
    std::set<char32_t> pressed_;
};

}  // namespace eti::hands
