// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/hand_controls.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "client/app/window/compositor.hpp"
#include "client/app/window/vantage_controls.hpp"
#include "client/text/catalogue.hpp"

namespace eti::client {
namespace {

std::string text_of(std::string_view english) {
    return std::string(text::translate(english));
}

std::optional<hands::HandPlayback> play_of(const std::filesystem::path& file) {
    return file.empty() ? std::nullopt : std::optional(hands::HandPlayback::load(file));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> hand_controls_help() {
    std::vector<std::pair<std::string, std::string>> out{
        {"Tab", text_of("switch hand: blade or tube")},
        {text_of("drag left"), text_of("move the tool in the picture's plane; it stays where released")},
        {text_of("drag right"), text_of("rotate the tool about its tip")},
        {text_of("wheel"), text_of("slide the tool in and out")},
        {text_of("shift+mouse"), text_of("move the view instead of the tool")},
        {"z", text_of("hand back to its initial pose")}};
    for (const HandKey& key : hand_keys()) {
        out.emplace_back(key.caption, text::translate(key.help));
    }
    return out;
}

std::vector<std::pair<std::string, std::string>> HandControls::help() {
    std::vector<std::pair<std::string, std::string>> out = hand_controls_help();
    for (auto& row : keys_help(true)) {
        const auto same = [&](const VantageKey& key) {
            return key.caption == row.first && key.key != loupe_key;
        };
        if (row.first != text::translate("mouse") && std::ranges::none_of(vantage_keys(), same)) {
            out.push_back(std::move(row));
        }
    }
    return out;
}

HandControls::HandControls(bus::Node& node, const std::filesystem::path& play, bool tutorial)
    : played_(!play.empty()), link_(node, play_of(play)) {
    if (tutorial) {
        tutorial_.emplace();
    }
}

bool HandControls::update(const view::SceneView& scene, const Selection& shown) {
    if (!tutorial_ || tutorial_->finished()) {
        return false;
    }
    const std::size_t before = tutorial_->lesson();
    tutorial_->update({scene, shown.name});
    if (tutorial_->finished()) {
        mark_tutorial_shown();
    }
    return tutorial_->lesson() != before;
}

const Selection& HandControls::shown(const Selection& chosen) const {
    const render::View* const view = link_.state().view;
    return view != nullptr ? *selection_named(view->name) : chosen;
}

bool HandControls::key(const KeyEvent& event) {
    if (tutorial_ && !tutorial_->finished() && event.key == skip_key) {
        if (!event.down || event.repeated) {
            return true;
        }
        tutorial_->skip();
        if (tutorial_->finished()) {
            mark_tutorial_shown();
        }
        return true;
    }
    if (!hands::is_hand_key(event.key)) {
        return false;
    }
    if (!played_ && !event.repeated) {
        event.down ? link_.press(event.key) : link_.release(event.key);
    }
    return true;
}

bool HandControls::drag(const hands::Drag& mouse, const Controls& controls, const view::SceneView& scene,
                        int width, int height) {
    if (mouse.shift) {
        return false;
    }
    if (played_ || !scene.complete()) {
        return true;
    }
    if (const auto placed =
            placed_at(controls.selection(), scene, width, height, mouse.from_x, mouse.from_y)) {
        link_.drag({mouse, placed->view->camera(scene, controls.vantage()),
                    static_cast<float>(placed->tile.height)});
    }
    return true;
}

void HandControls::add_to(hud::Readout& readout) const {
    if (tutorial_) {
        tutorial_->add_to(readout);
    }
    const hands::HandsState now = link_.state();
    if (!now.holding) {
        return;
    }
    const bool tube = now.chosen == Tool::tube;
    const bool ours = now.owned[static_cast<std::size_t>(now.chosen)];
    std::string line = tube ? text_of("tube in hand") : text_of("blade in hand");
    if (!ours) {
        line = tube ? text_of("a device holds the tube") : text_of("a device holds the blade");
    } else if (now.held_back >= 1.0f) {
        line = text::translate_format("{}, held back", line);
    }
    readout.guidance.push_back(fmt::format("{} (Tab: {})", line, tube ? text_of("blade") : text_of("tube")));
}

nlohmann::json HandControls::report() const {
    const hands::HandsState now = link_.state();
    nlohmann::json out{{"poses", {{"laryngoscope", now.poses[0]}, {"tube", now.poses[1]}}},
                       {"ours", {{"laryngoscope", now.owned[0]}, {"tube", now.owned[1]}}},
                       {"played", played_ && now.played}};
    if (tutorial_) {
        out["lessons_done"] = tutorial_->lesson();
    }
    return out;
}

}  // namespace eti::client
