// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/canvas.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <iterator>
#include <numeric>
#include <stdexcept>

#include "client/hud/letters.hpp"

namespace eti::panel {
namespace {

void set_style(float em) {
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowPadding = ImVec2(0.7f * em, 0.6f * em);
    style.FramePadding = ImVec2(0.45f * em, 0.22f * em);
    style.ItemSpacing = ImVec2(0.5f * em, 0.35f * em);
    style.ItemInnerSpacing = ImVec2(0.4f * em, 0.3f * em);
    style.ScrollbarSize = 0.8f * em;
    style.GrabMinSize = 0.8f * em;
    style.WindowRounding = 0.0f;
    style.WindowBorderSize = 0.0f;
    style.FrameRounding = 0.2f * em;
    style.GrabRounding = 0.2f * em;
    style.TabRounding = 0.25f * em;
    style.DisabledAlpha = 0.75f;
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.06f, 0.08f, 0.09f, 1.0f);
    style.Colors[ImGuiCol_ChildBg] = ImVec4(0.0f, 0.0f, 0.0f, 0.0f);
    ImGui::GetStyle() = style;
}

}  // namespace

Canvas::ContextScope::ContextScope(const Canvas& canvas) : before_(ImGui::GetCurrentContext()) {
    ImGui::SetCurrentContext(canvas.context_);
}

Canvas::ContextScope::~ContextScope() {
    ImGui::SetCurrentContext(before_);
}

Canvas::Canvas() {
    IMGUI_CHECKVERSION();
    ImGuiContext* const before = ImGui::GetCurrentContext();
    context_ = ImGui::CreateContext();
    ImGui::SetCurrentContext(context_);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
#if IMGUI_VERSION_NUM < 18700
    // Without a window there is no key map; Dear ImGui still requires one. Later versions need none, and
    // abort at the first key beside one.
    std::iota(std::begin(io.KeyMap), std::end(io.KeyMap), 0);
#endif
    const bool drawable = ImGui_ImplOpenGL3_Init("#version 330 core");
    if (!drawable) {
        ImGui::DestroyContext(context_);
    }
    ImGui::SetCurrentContext(before);
    if (!drawable) {
        throw std::runtime_error("the instructor's panel cannot be drawn with this OpenGL driver");
    }
}

Canvas::~Canvas() {
    {
        const ContextScope use(*this);
        if (attached_) {
            ImGui_ImplGlfw_Shutdown();
        }
        ImGui_ImplOpenGL3_Shutdown();
    }
    ImGuiContext* const before = ImGui::GetCurrentContext();
    ImGui::DestroyContext(context_);
    ImGui::SetCurrentContext(before);
}

void Canvas::attach(GLFWwindow* window) {
    const ContextScope use(*this);
    attached_ = ImGui_ImplGlfw_InitForOpenGL(window, true);
}

void Canvas::make_letters(int text_height) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    hud::add_letters(atlas, text_height);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    set_style(static_cast<float>(text_height));
    text_height_ = text_height;
}

void Canvas::begin(int width, int height, int text_height, float seconds) {
    ImGui_ImplOpenGL3_NewFrame();
    if (text_height != text_height_) {
        make_letters(text_height);
    }
    ImGuiIO& io = ImGui::GetIO();
    if (attached_) {
        ImGui_ImplGlfw_NewFrame();
        // Window coordinates may be larger than pixels.
        io.MousePos.x *= io.DisplayFramebufferScale.x;
        io.MousePos.y *= io.DisplayFramebufferScale.y;
    } else {
        io.DeltaTime = seconds;
    }
    io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
    io.DisplayFramebufferScale = ImVec2(1.0f, 1.0f);
    ImGui::NewFrame();
}

void Canvas::end() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace eti::panel
