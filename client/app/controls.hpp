// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "client/app/annotator.hpp"
#include "client/app/window/command_keys.hpp"
#include "client/app/window/selection.hpp"
#include "client/hands/drag.hpp"
#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/command_sender.hpp"

namespace eti::client {

/// Keys and their actions, for on-screen and command-line help. `commands`: include commands (observers
/// have none). `marks`: include the keys for writing and drawing.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> keys_help(bool commands, bool marks = false);

/// Whether a character has a function, in any role of a client.
[[nodiscard]] bool is_shortcut(char32_t key);

/// Keyboard and mouse of a window: select views, move the vantage, show help, send commands.
class Controls {
  public:
    using Time = CommandKeyMapper::Time;

    /// `commands`: null for an observer, who sends no commands.
    Controls(const Selection& selection, bus::CommandSender* commands, const render::Vantage& vantage = {})
        : selection_(&selection), commands_(commands), vantage_(vantage) {}

    /// Enables writing, pointing and drawing.
    void set_annotator(Annotator& annotator) { annotator_ = &annotator; }
    /// Allows a client other than the trainee's to show the trainee's view; `at_first`: initially on.
    void allow_trainee_view(bool at_first) {
        may_follow_trainee_ = true;
        follows_trainee_ = at_first;
    }
    /// Updates what depends on the scene: the trainee's eye while it is followed.
    void follow(const view::SceneView& scene);
    /// True while text is entered: every key belongs to the text.
    [[nodiscard]] bool writing() const { return annotator_ != nullptr && annotator_->writing(); }
    /// Only while writing(). A typed character, or one of special_keys.hpp.
    void type(char32_t key, Time now);

    /// A lower-case character or an arrow. `repeated`: auto-repeat of a held key.
    void press(char32_t key, bool repeated, const view::SceneView& scene, Time now);
    void release(char32_t key, Time now);
    /// A mouse drag in a picture of `width` x `height` pixels.
    void drag(const hands::Drag& mouse, const view::SceneView& scene, int width, int height, Time now = {});
    /// Processes the server's replies.
    void update(Time now);
    /// The server's refusals as of the last update().
    [[nodiscard]] std::span<const bus::Refusal> refusals() const { return refusals_; }
    /// Releases every key, for example when the window closes, so that no hold-to-run command stays on.
    void release_all_keys(Time now);

    [[nodiscard]] const Selection& selection() const { return *selection_; }
    [[nodiscard]] const render::Vantage& vantage() const { return vantage_; }
    /// Adds help and notices to the readout.
    void add_to(hud::Readout& readout, Time now) const;

  private:
    void send(const std::optional<CommandRequest>& command, Time now);
    void show_notice(std::string text, Time now);
    void draw_mark(const hands::Drag& mouse, const view::SceneView& scene, int width, int height, Time now);

    const Selection* selection_;
    bus::CommandSender* commands_;
    render::Vantage vantage_;
    CommandKeyMapper typing_;
    std::vector<bus::Refusal> refusals_;
    Annotator* annotator_ = nullptr;
    float marked_x_ = 0.0f, marked_y_ = 0.0f;  // [pixels] last point of the mark
    bool may_follow_trainee_ = false, follows_trainee_ = false;
    std::optional<view::TraineeEye> saved_eye_;  // the own eye while the trainee's is followed
    bool help_ = false;
    std::string notice_;
    Time notice_since_;
};

}  // namespace eti::client
