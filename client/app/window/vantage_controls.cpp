// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/vantage_controls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/text/catalogue.hpp"

namespace eti::client {
namespace {

using render::Vantage;

constexpr float turn_per_pixel = 0.35f * degree;
constexpr float zoom_per_notch = 0.92f;
// Moving the eye by the width of a mouth takes a hand's width of mouse travel.
constexpr float eye_per_pixel = 0.2e-3f;  // [m]
constexpr float eye_per_notch = 10e-3f;   // [m]
constexpr float gaze_per_pixel = 0.05f * degree;
constexpr float eye_per_key = 5e-3f;  // [m]

constexpr float plane_per_pixel = 0.1e-3f;  // [m]
constexpr float plane_per_notch = 1e-3f;    // [m]
constexpr float plane_per_key = 2e-3f;      // [m]
constexpr float plane_turn = 5.0f * degree;

constexpr std::array vantage_key_table{
    VantageKey{U'j', "j", text::translatable("eye to the left"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({-eye_per_key, 0.0f, 0.0f}, now);
               }},
    VantageKey{U'l', "l", text::translatable("eye to the right"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({eye_per_key, 0.0f, 0.0f}, now);
               }},
    VantageKey{U'i', "i", text::translatable("eye up"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, eye_per_key, 0.0f}, now);
               }},
    VantageKey{U'k', "k", text::translatable("eye down"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, -eye_per_key, 0.0f}, now);
               }},
    VantageKey{U'u', "u", text::translatable("eye closer"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, 0.0f, -eye_per_key}, now);
               }},
    VantageKey{U'o', "o", text::translatable("eye farther"),
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, 0.0f, eye_per_key}, now);
               }},
    VantageKey{loupe_key, "8",
               text::translatable("loupe on or off; while on, the wheel changes its magnification"),
               [](Vantage& v, const Landmarks&) { v.loupe.toggle(); }},
    VantageKey{U'c', "c", text::translatable("eye back to the best view"),
               [](Vantage& v, const Landmarks&) { v.eye.settle(); }},
    VantageKey{U',', ",", text::translatable("section deeper into the remaining half"),
               [](Vantage& v, const Landmarks&) { v.section.shift(-plane_per_key); }},
    VantageKey{U'.', ".", text::translatable("section away from the remaining half"),
               [](Vantage& v, const Landmarks&) { v.section.shift(plane_per_key); }},
    VantageKey{U'n', "n", text::translatable("section rotated to the right"),
               [](Vantage& v, const Landmarks&) { v.section.rotate(-plane_turn, 0.0f); }},
    VantageKey{U'm', "m", text::translatable("section rotated to the left"),
               [](Vantage& v, const Landmarks&) { v.section.rotate(plane_turn, 0.0f); }},
    VantageKey{U'v', "v", text::translatable("section tilted to the front"),
               [](Vantage& v, const Landmarks&) { v.section.rotate(0.0f, -plane_turn); }},
    VantageKey{U'b', "b", text::translatable("section tilted to the back"),
               [](Vantage& v, const Landmarks&) { v.section.rotate(0.0f, plane_turn); }},
    VantageKey{U'x', "x", text::translatable("section back to the middle"),
               [](Vantage& v, const Landmarks&) { v.section = {}; }},
};

void turn_onlooker(render::Orbit& orbit, const hands::Drag& mouse) {
    orbit.azimuth -= turn_per_pixel * mouse.x;
    orbit.elevation = std::clamp(orbit.elevation + turn_per_pixel * mouse.y, -60.0f * degree, 85.0f * degree);
    orbit.distance = std::clamp(orbit.distance * std::pow(zoom_per_notch, mouse.notches), 0.2f, 1.5f);
}

void move_eye(Vantage& vantage, const render::View& view, const hands::Drag& mouse, const Landmarks& now) {
    // Under a loupe the picture follows the mouse as far as without it.
    const bool worn = view.loupe && vantage.loupe.on();
    const float finer = worn ? 1.0f / vantage.loupe.magnification : 1.0f;
    if (mouse.right_button) {
        vantage.eye.turn(finer * gaze_per_pixel * mouse.x, -finer * gaze_per_pixel * mouse.y);
        return;
    }
    if (worn) {
        vantage.loupe.turn_wheel(mouse.notches);
    }
    vantage.eye.move({finer * eye_per_pixel * mouse.x, -finer * eye_per_pixel * mouse.y,
                      worn ? 0.0f : -eye_per_notch * mouse.notches},
                     now);
}

void move_section(render::Section& section, const hands::Drag& mouse) {
    section.shift(plane_per_notch * mouse.notches);
    if (mouse.right_button) {
        section.shift(-plane_per_pixel * mouse.y);
    } else {
        section.rotate(turn_per_pixel * mouse.x, turn_per_pixel * mouse.y);
    }
}

}  // namespace

std::span<const VantageKey> vantage_keys() {
    return vantage_key_table;
}

const VantageKey* vantage_key(char32_t key) {
    const auto found = std::ranges::find(vantage_key_table, key, &VantageKey::key);
    return found == vantage_key_table.end() ? nullptr : &*found;
}

void drag(Vantage& vantage, const render::View& view, const hands::Drag& mouse, const Landmarks& now) {
    switch (view.mouse_target) {
        case render::MouseTarget::onlooker:
            turn_onlooker(vantage.orbit, mouse);
            break;
        case render::MouseTarget::eye:
            move_eye(vantage, view, mouse, now);
            break;
        case render::MouseTarget::section:
            move_section(vantage.section, mouse);
            break;
    }
}

std::string_view mouse_help() {
    return text::translatable(
        "drag, wheel: camera in the overview, plane in the section, else the eye; right button: gaze, depth "
        "of "
        "the plane");
}

}  // namespace eti::client
