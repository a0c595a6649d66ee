// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/controls.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "client/app/window/compositor.hpp"
#include "client/app/window/vantage_controls.hpp"
#include "client/hands/hands.hpp"
#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"

namespace eti::client {
namespace {

using text::translatable;
using text::translate;

using namespace std::chrono_literals;

constexpr auto notice_for = 5s;
constexpr auto command_delivery_wait = 500ms;
constexpr float mark_step = 4.0f;  // [pixels], between two points of a drawn line

constexpr char32_t key_follow = U't', key_write = U'w', key_wipe = U'z';
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> mark_keys{
    {{"w", translatable("write a remark; Enter sends it")},
     {translatable("shift"),
      translatable("click to point, drag to draw; a remark being written is the label")},
     {"z", translatable("clear all marks")}}};

}  // namespace

std::vector<std::pair<std::string, std::string>> keys_help(bool commands, bool marks) {
    std::vector<std::pair<std::string, std::string>> out{
        {"h ?", std::string(translate("this help"))},
        {"p F1", std::string(translate("the instructor's panel"))},
        {"Esc", std::string(translate("end"))}};
    for (const Selection& one : selections()) {
        out.emplace_back(std::string(1, one.key),
                         fmt::format("{}: {}", translate(one.name), translate(one.help)));
    }
    out.emplace_back(translate("mouse"), translate(mouse_help()));
    for (const VantageKey& key : vantage_keys()) {
        out.emplace_back(key.caption, translate(key.help));
    }
    if (commands) {
        for (const CommandKey& key : command_keys()) {
            out.emplace_back(translate(key.caption), translate(key.help));
        }
    }
    if (marks || !commands) {
        out.emplace_back("t", translate("the trainee's eye, or a free viewpoint"));
    }
    if (marks) {
        for (const auto& [key, help] : mark_keys) {
            out.emplace_back(translate(key), translate(help));
        }
    }
    return out;
}

bool is_shortcut(char32_t key) {
    constexpr std::u32string_view others = U"h?ptwz";
    return (key < 128 && selection_for_key(static_cast<char>(key)) != nullptr) ||
           vantage_key(key) != nullptr || command_key(key) != nullptr || hands::is_hand_key(key) ||
           others.find(key) != others.npos;
}

void Controls::press(char32_t key, bool repeated, const view::SceneView& scene, Time now) {
    if (const Selection* const chosen = key < 128 ? selection_for_key(static_cast<char>(key)) : nullptr) {
        selection_ = chosen;
    } else if (key == U'h' || key == U'?') {
        help_ = repeated ? help_ : !help_;
    } else if (key == key_follow && may_follow_trainee_ && !repeated) {
        follows_trainee_ = !follows_trainee_;
        if (follows_trainee_ && !scene.trainee_eye()) {
            show_notice(std::string(translate("no trainee's client reports an eye position")), now);
        }
    } else if (key == key_write && annotator_ != nullptr && !repeated) {
        annotator_->write();
    } else if (key == key_wipe && annotator_ != nullptr && !repeated) {
        annotator_->wipe();
    } else if (const VantageKey* const moved = vantage_key(key)) {
        moved->press(vantage_, scene.landmarks());
    } else if (const CommandKey* const command = command_key(key)) {
        if (commands_ == nullptr) {
            show_notice(std::string(translate("observers cannot send commands")), now);
        } else if (!scene.metrics()) {
            show_notice(std::string(translate("no server has reported its patient's state yet")), now);
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

void Controls::follow(const view::SceneView& scene) {
    if (follows_trainee_ && scene.trainee_eye()) {
        saved_eye_ = saved_eye_ ? saved_eye_ : vantage_.eye;
        vantage_.eye = view::TraineeEye::from_headset(*scene.trainee_eye());
    } else if (saved_eye_) {
        vantage_.eye = *std::exchange(saved_eye_, std::nullopt);
    }
    if (annotator_ != nullptr) {
        vantage_.sketch = annotator_->sketch();
    }
}

void Controls::type(char32_t key, Time now) {
    annotator_->press(key);
    if (std::string trouble = annotator_->take_error(); !trouble.empty()) {
        show_notice(std::move(trouble), now);
    }
}

void Controls::draw_mark(const hands::Drag& mouse, const view::SceneView& scene, int width, int height,
                         Time now) {
    const bool moved = std::hypot(mouse.at_x - marked_x_, mouse.at_y - marked_y_) >= mark_step;
    if (mouse.mark == hands::Drag::Mark::continues && !moved) {
        return;
    }
    marked_x_ = mouse.at_x;
    marked_y_ = mouse.at_y;
    if (mouse.mark == hands::Drag::Mark::ends) {
        annotator_->end();
    } else if (const auto placed =  // the picture in which the mark began
               placed_at(*selection_, scene, width, height, mouse.from_x, mouse.from_y)) {
        const auto left = static_cast<float>(placed->tile.x), top = static_cast<float>(placed->tile.y);
        const auto wide = static_cast<float>(placed->tile.width),
                   high = static_cast<float>(placed->tile.height);
        const float x = 2.0f * (mouse.at_x + 0.5f - left) / wide - 1.0f;
        const float y = 1.0f - 2.0f * (mouse.at_y + 0.5f - top) / high;
        const bool inside = std::abs(x) <= 1.0f && std::abs(y) <= 1.0f;
        const auto at =
            inside ? render::pick(*placed->view, scene, vantage_, wide / high, x, y) : std::nullopt;
        mouse.mark == hands::Drag::Mark::begins ? annotator_->begin(at) : annotator_->extend(at);
    }
    if (std::string trouble = annotator_->take_error(); !trouble.empty()) {
        show_notice(std::move(trouble), now);
    }
}

void Controls::drag(const hands::Drag& mouse, const view::SceneView& scene, int width, int height, Time now) {
    if (mouse.mark != hands::Drag::Mark::none && annotator_ != nullptr) {
        draw_mark(mouse, scene, width, height, now);
        return;
    }
    if (const auto placed = placed_at(*selection_, scene, width, height, mouse.from_x, mouse.from_y)) {
        client::drag(vantage_, *placed->view, mouse, scene.landmarks());
    }
}

void Controls::release_all_keys(Time now) {
    bool any = false;
    for (const CommandKey& key : command_keys()) {
        if (const auto command = typing_.release(key)) {
            send(command, now);
            any = true;
        }
    }
    if (any) {
        commands_->wait_until_received(command_delivery_wait);
    }
}

void Controls::update(Time now) {
    if (commands_ != nullptr) {
        refusals_ = commands_->take_answers();
        for (const bus::Refusal& refusal : refusals_) {
            show_notice(text::translate_format("refused: {}", text::translate_sentence(refusal.reason)), now);
        }
    }
}

void Controls::send(const std::optional<CommandRequest>& command, Time now) {
    if (command && !commands_->send(command->name, command->value)) {
        show_notice(std::string(translate("no server accepts commands")), now);
    }
}

void Controls::show_notice(std::string text, Time now) {
    notice_ = std::move(text);
    notice_since_ = now;
}

void Controls::add_to(hud::Readout& readout, Time now) const {
    if (help_) {
        readout.keys = keys_help(commands_ != nullptr, annotator_ != nullptr);
    }
    if (writing()) {
        readout.notice = text::translate_format("remark: {}_", annotator_->words());
        return;
    }
    if (now - notice_since_ < notice_for) {
        readout.notice = notice_;
    }
}

}  // namespace eti::client
