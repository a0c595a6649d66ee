// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/headset_panel.hpp"

#include <cmath>

#include "common/math/units.hpp"

namespace eti::client {

hmd::Quad HeadsetPanel::place() {
    constexpr float aside = 40.0f * degree, away = 0.9f, below = 0.05f;  // [rad], [m], [m]
    constexpr float wide = 0.54f;                                        // [m]
    const Quatf facing(Eigen::AngleAxisf(-aside, Vec3f::UnitY()));
    return {RigidTransform::from(facing, {away * std::sin(aside), -below, -away * std::cos(aside)}), wide,
            wide * height / width};
}

void HeadsetPanel::point(hmd::HandInput& hands) {
    const hmd::Quad here = place();
    laser_.follow(shown_ ? &here : nullptr, hands);
    drawing_.set_pointer(laser_.pointer(width, height));
}

const render::RenderTarget& HeadsetPanel::draw(Time now) {
    picture_.bind_picture();
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    drawing_.draw_full_screen(model_, width, height, now);
    return picture_;
}

}  // namespace eti::client
