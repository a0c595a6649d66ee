// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/vantage_controls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eti::client {
namespace {

using render::Vantage;

constexpr float turn_per_pixel = 0.35f * degree;
constexpr float zoom_per_notch = 0.92f;
// A mouth's width of eye movement takes a hand's width of mouse.
constexpr float eye_per_pixel = 0.2e-3f;  // [m]
constexpr float eye_per_notch = 10e-3f;   // [m]
constexpr float gaze_per_pixel = 0.05f * degree;
constexpr float eye_per_key = 5e-3f;  // [m]

constexpr std::array keys{
    VantageKey{U'j', "j", "eye to the left",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({-eye_per_key, 0.0f, 0.0f}, now);
               }},
    VantageKey{U'l', "l", "eye to the right",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({eye_per_key, 0.0f, 0.0f}, now);
               }},
    VantageKey{U'i', "i", "eye up",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, eye_per_key, 0.0f}, now);
               }},
    VantageKey{U'k', "k", "eye down",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, -eye_per_key, 0.0f}, now);
               }},
    VantageKey{U'u', "u", "eye nearer",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, 0.0f, -eye_per_key}, now);
               }},
    VantageKey{U'o', "o", "eye farther",
               [](Vantage& v, const Landmarks& now) {
                   v.eye.move({0.0f, 0.0f, eye_per_key}, now);
               }},
    VantageKey{U'c', "c", "eye back to where it sees best",
               [](Vantage& v, const Landmarks&) { v.eye.settle(); }},
};

void turn_onlooker(render::Orbit& orbit, const Drag& mouse) {
    orbit.azimuth -= turn_per_pixel * mouse.x;
    orbit.elevation = std::clamp(orbit.elevation + turn_per_pixel * mouse.y, -60.0f * degree, 85.0f * degree);
    orbit.distance = std::clamp(orbit.distance * std::pow(zoom_per_notch, mouse.notches), 0.2f, 1.5f);
}

void move_eye(view::TraineeEye& eye, const Drag& mouse, const Landmarks& now) {
    if (mouse.second) {
        eye.turn(gaze_per_pixel * mouse.x, -gaze_per_pixel * mouse.y);
    } else {
        eye.move({eye_per_pixel * mouse.x, -eye_per_pixel * mouse.y, -eye_per_notch * mouse.notches}, now);
    }
}

}  // namespace

std::span<const VantageKey> vantage_keys() {
    return keys;
}

const VantageKey* vantage_key(char32_t key) {
    const auto found = std::ranges::find(keys, key, &VantageKey::key);
    return found == keys.end() ? nullptr : &*found;
}

void drag(Vantage& vantage, const render::View& view, const Drag& mouse, const Landmarks& now) {
    switch (view.moves) {
        case render::Moves::onlooker:
            turn_onlooker(vantage.orbit, mouse);
            break;
        case render::Moves::eye:
            move_eye(vantage.eye, mouse, now);
            break;
        case render::Moves::nothing:
            break;
    }
}

std::string_view mouse_help() {
    return "drag and wheel: from outside the onlooker, else the eye; right button: the eye's gaze";
}

}  // namespace eti::client
