// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hands.hpp"

#include <algorithm>

#include "client/hands/picture_plane.hpp"
#include "common/math/axes.hpp"

namespace eti::hands {
namespace {

constexpr float in_the_mouth = 5e-3f;      // [m], of tube beyond the lips
constexpr float before_the_mouth = 0.03f;  // [m]

const HandKey* find_hand_key(char32_t key) {
    const auto found = std::ranges::find(hand_keys(), key, &HandKey::key);
    return found == hand_keys().end() ? nullptr : &*found;
}

}  // namespace

bool is_hand_key(char32_t key) {
    return key == other_hand_key || key == home_key || find_hand_key(key) != nullptr;
}

RigidTransform hand_start(Tool tool, const Landmarks& now, const Laryngoscope& scope, const Tube& tube) {
    const Vec3f& mouth = at(now, Landmark::mouth_opening);
    const bool blade = tool == Tool::laryngoscope;
    // The blade is inserted steeply, past the upper gum; the tube tip halfway towards the throat.
    const Vec3f direction = blade ? Vec3f(0.0f, 1.0f, -0.15f) : Vec3f(0.0f, 1.0f, -1.0f);
    const Quatf rotation(tool_axes(direction));
    const Vec3f aside(blade ? -9e-3f : -16e-3f, 0.0f, 0.0f);
    const Vec3f back = -before_the_mouth * (rotation * Vec3f::UnitZ());
    const Vec3f tip = mouth + aside + back + (blade ? Vec3f(0.0f, 0.0f, 4e-3f) : Vec3f(0.0f, -0.02f, 0.02f));
    const float curvature = blade ? 0.0f : 1.0f / tube.curve_radius;
    const float length = blade ? scope.blade_length : tube.grip_from_tip;
    const RigidTransform to_tip = along_arc(curvature, length);
    return RigidTransform{rotation, tip} * to_tip.inverse();
}

Hands::Hands(const Laryngoscope& scope, const Tube& tube, const Landmarks& now)
    : tools_{
          HeldTool(scope.blade_length, 0.0f, hand_start(Tool::laryngoscope, now, scope, tube)),
          HeldTool(tube.grip_from_tip, 1.0f / tube.curve_radius, hand_start(Tool::tube, now, scope, tube))} {}

bool Hands::press(char32_t key) {
    if (key == other_hand_key) {
        chosen_ = chosen_ == Tool::tube ? Tool::laryngoscope : Tool::tube;
        return true;
    }
    if (key == home_key) {
        active_tool().go_home();
        return true;
    }
    if (find_hand_key(key) == nullptr) {
        return false;
    }
    pressed_.insert(key);
    return true;
}

void Hands::release(char32_t key) {
    pressed_.erase(key);
}

void Hands::drag(const HandDrag& drag, const Landmarks& now) {
    HeldTool& tool = active_tool();
    const auto carried = [&](const Vec3f& point) {
        return picture_displacement(drag.camera, drag.height, point, drag.mouse.x, drag.mouse.y);
    };
    tool.slide(slide_per_notch * drag.mouse.notches);
    const float outside = tool.arc_length_to(at(now, Landmark::mouth_opening));
    if (drag.mouse.right_button) {
        tool.swing_grip(carried(tool.pose().translation));
    } else if (chosen_ == Tool::tube && outside < tool.length() - in_the_mouth) {
        tool.swing_tip(tool.point_at(outside), carried(tool.tip()));
    } else {
        tool.move(carried(tool.tip()));
    }
}

void Hands::advance(float dt, const Overtravel& blade, const Overtravel& tube) {
    for (const char32_t key : pressed_) {
        active_tool().hold(*find_hand_key(key), dt);
    }
    tools_[static_cast<std::size_t>(Tool::laryngoscope)].advance(dt, blade);
    tools_[static_cast<std::size_t>(Tool::tube)].advance(dt, tube);
}

}  // namespace eti::hands
