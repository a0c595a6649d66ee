// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

struct GLFWwindow;
struct ImGuiContext;

namespace eti::panel {

/// Dear ImGui's state for one panel, apart from that of the overlay, with an OpenGL renderer and letters of
/// any size. For the OpenGL context current when it was made.
class Canvas {
  public:
    /// Throws std::runtime_error where the driver cannot draw it.
    Canvas();
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    /// While it lives, Dear ImGui's functions mean this canvas; afterwards what they meant before.
    class Use {
      public:
        explicit Use(const Canvas& canvas);
        ~Use();
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;

      private:
        ImGuiContext* before_;
    };

    /// Mouse, keys and clipboard are this window's from now on. What the window did with them it still does.
    void attach(GLFWwindow* window);
    /// Begins a frame of so many pixels with letters so high, of `seconds` since the one before. In use.
    void begin(int width, int height, int text_height, float seconds);
    /// Draws the frame into the bound framebuffer. In use.
    void end();

  private:
    void make_letters(int text_height);

    ImGuiContext* context_;
    bool attached_ = false;
    int text_height_ = 0;
};

}  // namespace eti::panel
