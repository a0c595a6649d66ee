// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hand_playback.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/units.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti::hands {
namespace {

constexpr Range pixels{-4000.0f, 4000.0f}, notches{-200.0f, 200.0f}, seconds{0.0f, 60.0f};

bool reached(const PlaybackStep& step, const view::SceneView& seen) {
    const bool waits = step.until_view_percent >= 0.0f || step.until_tube_depth >= 0.0f;
    return waits && seen.metrics() &&
           (step.until_view_percent < 0.0f ||
            seen.measures().glottic_opening_percent >= step.until_view_percent) &&
           (step.until_tube_depth < 0.0f || seen.measures().tube_depth_past_glottis >= step.until_tube_depth);
}

const std::vector<std::string_view>& view_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> out;
        for (const render::View& view : render::views()) {
            out.push_back(view.name);
        }
        return out;
    }();
    return names;
}

PlaybackStep read_step(YamlMap map) {
    constexpr std::array<std::string_view, 2> hands{"blade", "tube"};
    constexpr std::array<std::string_view, 2> buttons{"left", "right"};
    PlaybackStep step;
    (void)map.name("step", "");
    if (map.has("view")) {
        step.view = render::view_named(view_names()[map.choice("view", 0, view_names())]);
    }
    step.selects_hand = map.has("hand");
    step.hand = map.choice("hand", 0, hands) == 1 ? Tool::tube : Tool::laryngoscope;
    step.mouse.right_button = map.choice("button", 0, buttons) == 1;
    step.mouse.x = map.number("right_px", 0.0f, pixels);
    step.mouse.y = map.number("down_px", 0.0f, pixels);
    step.mouse.notches = map.number("notches", 0.0f, notches);
    step.duration = map.number("over_s", 0.5f, seconds);
    if (map.has("key")) {
        const std::string key = map.text("key", "");
        const auto known = [&](const HandKey& row) { return row.caption == key; };
        const auto row = std::ranges::find_if(hand_keys(), known);
        if (row == hand_keys().end()) {
            map.refuse("key", "'" + key + "'", "one of the keys that move the hand: w q g f a d t y");
        }
        step.hold = row->key;
    }
    if (auto until = map.map("until")) {
        step.until_view_percent = until->number("view_percent", -1.0f, {0.0f, 100.0f});
        step.until_tube_depth = until->number("tube_depth_mm", -1.0f, {-100.0f, 100.0f, millimetre});
        until->finish();
    }
    map.finish();
    return step;
}

}  // namespace

HandPlayback HandPlayback::load(const std::filesystem::path& file) {
    return parse(read_text_file(file), file.string());
}

HandPlayback HandPlayback::parse(const std::string& text, const std::string& file) {
    YamlMap map = YamlMap::parse(text, file);
    HandPlayback play;
    (void)map.name("name", "");
    (void)map.text("description", "");
    play.height_ = static_cast<float>(map.whole("picture_height_px", 540, 64, 7680));
    for (YamlMap& step : map.list("steps")) {
        play.steps_.push_back(read_step(std::move(step)));
    }
    map.finish();
    return play;
}

void HandPlayback::advance(float dt, Hands& hands, const view::SceneView& seen,
                           const render::Vantage& vantage) {
    if (finished() || !(dt > 0.0f)) {
        return;
    }
    const PlaybackStep& step = steps_[step_];
    if (!step_started_) {
        step_started_ = true;
        elapsed_ = 0.0f;
        view_ = step.view != nullptr ? step.view : view_;
        if (step.selects_hand) {
            hands.choose(step.hand);
        }
        if (step.hold != U'\0') {
            (void)hands.press(step.hold);
        }
    }
    const float before = elapsed_;
    elapsed_ = std::min(elapsed_ + dt, step.duration);
    const float share = step.duration > 0.0f ? (elapsed_ - before) / step.duration : 1.0f;
    if (view_ != nullptr) {
        HandDrag drag{step.mouse, view_->camera(seen, vantage), height_};
        drag.mouse.x *= share;
        drag.mouse.y *= share;
        drag.mouse.notches *= share;
        hands.drag(drag, seen.landmarks());
    }
    if (elapsed_ >= step.duration || reached(step, seen)) {
        hands.release(step.hold);
        step_started_ = false;
        ++step_;
    }
}

}  // namespace eti::hands
