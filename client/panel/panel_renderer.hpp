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

/// Text height of the panel [pixels] for a picture height: a fiftieth of it, at least 13, times `text_scale`.
[[nodiscard]] int text_height(int height, float text_scale = 1.0f);

/// The panel's area in a picture: at the right, or below if the picture is too narrow. The scene gets the
/// rest.
[[nodiscard]] Area panel_area(int width, int height, float text_scale = 1.0f);
[[nodiscard]] Area scene_area(int width, int height, float text_scale = 1.0f);

/// Pointer for a panel without a window: a test, or a laser pointer.
struct Pointer {
    float x = 0.0f, y = 0.0f;
    bool down = false;
    float wheel = 0.0f;  ///< notches
};

/// Draws a Model and passes user input to it. The caller binds the target: a window's framebuffer or a
/// texture.
class PanelRenderer {
  public:
    /// With a window, takes mouse and keyboard from it.
    explicit PanelRenderer(GLFWwindow* window = nullptr, float text_scale = 1.0f);

    /// Draws into a picture of `width` x `height` pixels, at panel_area().
    void draw(Model& model, int width, int height, Model::Time now);
    /// Draws a picture that contains only the panel, with the pointer, and an on-screen keyboard during
    /// text entry. Letters are as high as the panel's width allows.
    void draw_full_screen(Model& model, int width, int height, Model::Time now);
    /// Replaces the mouse from now on, without a window.
    void set_pointer(const Pointer& pointer);
    /// Gives the panel the keyboard focus from the next frame on: on the patient page, the search field.
    void focus_keyboard() { focus_keyboard_ = true; }

    /// Discards input received while the panel is hidden.
    void discard_input();

    /// Makes the panel's context current for Dear ImGui while a window's events are processed.
    [[nodiscard]] Canvas::ContextScope make_current() const { return Canvas::ContextScope(canvas_); }
    /// As of the last frame: the panel captures mouse or keyboard.
    [[nodiscard]] bool has_mouse() const { return has_mouse_; }
    [[nodiscard]] bool has_keyboard() const { return has_keyboard_; }
    /// A text field has the focus.
    [[nodiscard]] bool has_text() const { return has_text_; }

    /// Area of a control in the last frame, by parameter name or English button text; nullopt if it was not
    /// drawn or is scrolled out of view.
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
    /// `words` in English; shown translated.
    bool button(const std::string& words);
    void record_place(std::string_view control);

    Canvas canvas_;
    float text_scale_;
    std::map<std::string, Area, std::less<>> places_;
    std::string held_;            // the row whose slider is dragged or edited
    std::optional<float> typed_;  // its value so far
    std::optional<Page> drawn_page_;
    std::optional<Model::Time> last_;
    bool confirming_stop_ = false;
    bool shows_keyboard_ = false;  // on-screen keyboard
    bool shows_pointer_ = false;
    bool focus_keyboard_ = false;
    bool has_mouse_ = false, has_keyboard_ = false, has_text_ = false;
};

}  // namespace eti::panel
