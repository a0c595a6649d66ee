// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "client/panel/canvas.hpp"
#include "client/panel/model.hpp"

namespace eti::panel {

/// Pixels from the upper left.
struct Area {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Height of the panel's letters [pixels] in a picture so high: a fiftieth of it, and 13 at least.
[[nodiscard]] int text_height(int height);

/// Where a panel lies in a picture: at its right, or where that is too narrow below. The rest is the scene's.
[[nodiscard]] Area panel_area(int width, int height);
[[nodiscard]] Area scene_area(int width, int height);

/// What points at a panel where no window does: a test, or a laser pointer.
struct Pointer {
    float x = 0.0f, y = 0.0f;
    bool down = false;
    float wheel = 0.0f;  ///< notches
};

/// Draws a Model and hands it what a person does. What it draws into is for the caller to bind: a window's
/// framebuffer or a texture.
class Drawing {
  public:
    /// With a window, mouse and keys are its own.
    explicit Drawing(GLFWwindow* window = nullptr);

    /// Into a picture of `width` x `height` pixels, where panel_area() says.
    void draw(Model& model, int width, int height, Model::Time now);
    /// The same, where the picture has nothing but the panel; what points at it is shown, and keys to point
    /// at while a text is typed. Letters are as high as the panel's width allows.
    void draw_alone(Model& model, int width, int height, Model::Time now);
    /// From now on, without a window.
    void point(const Pointer& pointer);
    /// Keys go to the panel from the next frame on: on the patient's page to the search.
    void take_keyboard() { take_keyboard_ = true; }

    /// While the panel is not drawn: what was typed meanwhile is not for it.
    void forget_input();

    /// What Dear ImGui's functions mean while a window's events come in.
    [[nodiscard]] Canvas::Use listen() const { return Canvas::Use(canvas_); }
    /// As of the last frame: what the mouse does, and what keys are pressed, is the panel's.
    [[nodiscard]] bool has_mouse() const { return has_mouse_; }
    [[nodiscard]] bool has_keyboard() const { return has_keyboard_; }
    /// A text is being typed.
    [[nodiscard]] bool has_text() const { return has_text_; }

    /// Where in the last frame a control was: of a value by its name, or of a button by its text. What was
    /// not drawn, or lies outside of what scrolls, is nowhere.
    [[nodiscard]] std::optional<Area> place(std::string_view control) const;

  private:
    void draw_into(const Area& area, int letters, Model& model, int width, int height, Model::Time now);
    void draw_head(const Model& model, Model::Time now);
    void draw_page(Model& model);
    void draw_patient(Model& model);
    void draw_presets(Model& model);
    void draw_group(Model& model, Group group, std::string_view heading);
    void draw_slider(Model& model, std::size_t row);
    void draw_aids(Model& model);
    void draw_session(Model& model);
    void draw_plots(const Model& model);
    void draw_health(const Model& model);
    [[nodiscard]] float keyboard_height() const;
    void draw_keyboard(std::string& typed);
    bool button(const std::string& text);
    void note_place(std::string_view control);

    Canvas canvas_;
    std::map<std::string, Area, std::less<>> places_;
    std::string held_;            // the row whose slider is held, or typed into
    std::optional<float> typed_;  // into it, so far
    std::optional<Page> drawn_page_;
    std::optional<Model::Time> last_;
    bool asks_to_stop_ = false;
    bool types_ = false;  // by keys that are drawn
    bool shows_pointer_ = false;
    bool take_keyboard_ = false;
    bool has_mouse_ = false, has_keyboard_ = false, has_text_ = false;
};

}  // namespace eti::panel
