// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/hand_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/app/headset/laser_pointer.hpp"
#include "client/app/window/command_keys.hpp"

namespace eti::client {
namespace {

// Dead zone in the middle of the pad.
constexpr float pad_middle = 0.3f;

// The key for the side on which a pad is pressed; 0: none.
char32_t key_of(const hmd::Pad& pad, char32_t up, char32_t down, char32_t left, char32_t right) {
    if (!pad.pressed || std::hypot(pad.x, pad.y) < pad_middle) {
        return 0;
    }
    if (std::abs(pad.y) >= std::abs(pad.x)) {
        return pad.y > 0.0f ? up : down;
    }
    return pad.x > 0.0f ? right : left;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 5> help{
    {{"trigger", "suction while held; a click when pointing at the panel"},
     {"right pad", "pressed up or down: head; right or left: jaw open or closed"},
     {"left pad", "pressed up or down: table"},
     {"menu", "right: enhanced view; left: panel"},
     {"two buttons", "right: suction, enhanced view; left: head up, head down"}}};

}  // namespace

std::vector<KeyEvent> HandKeys::follow(const hmd::HandInput& hands) {
    std::set<char32_t> now;
    if (trigger_pulled(std::max(hands.hands[0].trigger, hands.hands[1].trigger), held_.contains(U's'))) {
        now.insert(U's');
    }
    now.insert(key_of(hands.head_and_jaw, key_up, key_down, key_left, key_right));
    now.insert(key_of(hands.table, U']', U'[', 0, 0));
    if (hands.head_up) {
        now.insert(key_up);
    }
    if (hands.head_down) {
        now.insert(key_down);
    }
    if (hands.enhanced) {
        now.insert(U'e');
    }
    if (hands.panel) {
        now.insert(U'p');
    }
    now.erase(0);
    std::vector<KeyEvent> out;
    for (const char32_t key : held_) {
        if (!now.contains(key)) {
            out.push_back({key, false, false});
        }
    }
    for (const char32_t key : now) {
        out.push_back({key, true, held_.contains(key)});
    }
    held_ = std::move(now);
    return out;
}

std::span<const std::pair<std::string_view, std::string_view>> hands_help() {
    return help;
}

}  // namespace eti::client
