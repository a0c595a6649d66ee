// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/controls.hpp"

#include <fmt/format.h>

#include "client/app/compositor.hpp"
#include "client/app/vantage_controls.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;

constexpr auto notice_for = 5s;
constexpr auto farewell = 500ms;

}  // namespace

std::vector<std::pair<std::string, std::string>> keys_help(bool commands) {
    std::vector<std::pair<std::string, std::string>> out{
        {"h ?", "this list"}, {"p F1", "the instructor's panel"}, {"Esc", "end"}};
    for (const Selection& one : selections()) {
        out.emplace_back(std::string(1, one.key), fmt::format("{}: {}", one.name, one.help));
    }
    out.emplace_back("mouse", mouse_help());
    for (const VantageKey& key : vantage_keys()) {
        out.emplace_back(key.caption, key.help);
    }
    if (commands) {
        for (const CommandKey& key : command_keys()) {
            out.emplace_back(key.caption, key.help);
        }
    }
    return out;
}

void Controls::press(char32_t key, bool repeated, const view::SceneView& scene, Time now) {
    if (const Selection* const chosen = key < 128 ? selection_of_key(static_cast<char>(key)) : nullptr) {
        selection_ = chosen;
    } else if (key == U'h' || key == U'?') {
        help_ = repeated ? help_ : !help_;
    } else if (const VantageKey* const moved = vantage_key(key)) {
        moved->press(vantage_, scene.landmarks());
    } else if (const CommandKey* const command = command_key(key)) {
        if (commands_ == nullptr) {
            say("an observer gives no commands", now);
        } else if (!scene.metrics()) {
            say("no server has said yet how its patient is", now);
        } else {
            send(typing_.press(*command, repeated, scene.live(), now), now);
        }
    }
}

void Controls::release(char32_t key, Time now) {
    if (const CommandKey* const command = command_key(key)) {
        send(typing_.release(*command), now);
    }
}

void Controls::drag(const Drag& mouse, const view::SceneView& scene, int width, int height) {
    for (const auto& [view, tile] : layout(selection_->views(scene), width, height)) {
        const float x = mouse.from_x - static_cast<float>(tile.x);
        const float y = mouse.from_y - static_cast<float>(tile.y);
        if (x >= 0.0f && y >= 0.0f && x < static_cast<float>(tile.width) &&
            y < static_cast<float>(tile.height)) {
            client::drag(vantage_, *view, mouse, scene.landmarks());
        }
    }
}

void Controls::let_go(Time now) {
    bool any = false;
    for (const CommandKey& key : command_keys()) {
        if (const auto command = typing_.release(key)) {
            send(command, now);
            any = true;
        }
    }
    if (any) {
        commands_->wait_until_received(farewell);
    }
}

void Controls::tend(Time now) {
    if (commands_ != nullptr) {
        refusals_ = commands_->take_answers();
        for (const bus::Refusal& refusal : refusals_) {
            say(fmt::format("refused: {}", refusal.reason), now);
        }
    }
}

void Controls::send(const std::optional<WantedCommand>& command, Time now) {
    if (command && !commands_->send(command->name, command->value)) {
        say("no server takes commands", now);
    }
}

void Controls::say(std::string text, Time now) {
    notice_ = std::move(text);
    notice_since_ = now;
}

void Controls::put_into(hud::Readout& readout, Time now) const {
    if (help_) {
        readout.keys = keys_help(commands_ != nullptr);
    }
    if (now - notice_since_ < notice_for) {
        readout.notice = notice_;
    }
}

}  // namespace eti::client
