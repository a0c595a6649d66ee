// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/window_panel.hpp"

#include <epoxy/gl.h>

#include "client/app/window/command_keys.hpp"

namespace eti::client {

void WindowPanel::poll_events() {
    const auto listening = drawing_.make_current();
    window_.poll_events();
    if (!shown_) {
        drawing_.discard_input();
    }
}

bool WindowPanel::press(const KeyEvent& event) {
    if (!event.down) {
        return false;  // the receiver of a press also receives its release
    }
    const bool typing = shown_ && drawing_.has_text();
    if (event.key == key_f1 || (event.key == U'p' && !typing)) {
        if (!event.repeated) {
            shown_ = !shown_;
            drawing_.focus_keyboard();
        }
        return true;
    }
    return has_keyboard();
}

panel::Area WindowPanel::scene_area() const {
    return shown_ ? panel::scene_area(window_.width(), window_.height(), text_scale_)
                  : panel::Area{0, 0, window_.width(), window_.height()};
}

void WindowPanel::draw(Time now) {
    if (!shown_) {
        return;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_.width(), window_.height());
    drawing_.draw(model_, window_.width(), window_.height(), now);
}

}  // namespace eti::client
