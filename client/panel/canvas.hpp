// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

struct GLFWwindow;
struct ImGuiContext;

namespace eti::panel {

/// A Dear ImGui context for one panel, separate from the overlay's, with an OpenGL renderer and fonts of
/// any size. For the OpenGL context current at construction.
class Canvas {
  public:
    /// Throws std::runtime_error if the driver cannot support it.
    Canvas();
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    /// Makes this canvas the current Dear ImGui context; restores the previous one on destruction.
    class ContextScope {
      public:
        explicit ContextScope(const Canvas& canvas);
        ~ContextScope();
        ContextScope(const ContextScope&) = delete;
        ContextScope& operator=(const ContextScope&) = delete;

      private:
        ImGuiContext* before_;
    };

    /// Installs mouse, keyboard and clipboard handlers on this window, chaining to its existing ones.
    void attach(GLFWwindow* window);
    /// Begins a frame of this size [pixels] and text height, `seconds` after the previous one. Requires a
    /// ContextScope.
    void begin(int width, int height, int text_height, float seconds);
    /// Draws the frame into the bound framebuffer. Requires a ContextScope.
    void end();

  private:
    void make_letters(int text_height);

    ImGuiContext* context_;
    bool attached_ = false;
    int text_height_ = 0;
};

}  // namespace eti::panel
