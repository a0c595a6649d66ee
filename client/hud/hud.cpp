// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/hud.hpp"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "client/hud/text_box.hpp"

namespace eti::hud {
namespace {

constexpr float panel_width = 330.0f, guidance_width = 300.0f;
constexpr float above_titles = 24.0f;  // of tiles, at their lower edge
constexpr int least_tile_width = 400,
              least_tile_height = 230;  // the numbers would cover half of a smaller tile

// 13-pixel letters suit a laptop's screen; screens with more pixels are not larger.
int scale_of(int width, int height) {
    const int shorter = std::min(width, height);
    return shorter < 900 ? 1 : shorter < 1800 ? 2 : 4;
}

// Dims values from a lost server, so that they do not look current.
void dim(ImDrawList& list, int from, int to) {
    constexpr ImU32 opacity = 90;  // of 255
    for (int i = from; i < to; ++i) {
        ImU32& colour = list.VtxBuffer[i].col;
        if (colour == shade) {
            continue;  // text stays readable before the first picture
        }
        const ImU32 alpha = (colour >> IM_COL32_A_SHIFT & 0xffu) * opacity / 255u;
        colour = (colour & ~IM_COL32_A_MASK) | alpha << IM_COL32_A_SHIFT;
    }
}

Tile downscaled(const Tile& tile, int scale) {
    Tile out{tile.title, tile.x / scale, tile.y / scale, tile.width / scale, tile.height / scale, tile.marks};
    for (Mark& mark : out.marks) {
        mark.from /= static_cast<float>(scale);
        mark.to /= static_cast<float>(scale);
    }
    return out;
}

}  // namespace

Hud::Hud() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
        ImGui::DestroyContext();
        throw std::runtime_error("the text overlay cannot be drawn with this OpenGL driver");
    }
}

Hud::~Hud() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

// From here on one unit is `scale` pixels of the picture.
void Hud::begin(int width, int height, int scale) {
    ImGuiIO& io = ImGui::GetIO();
    auto [fonts, is_new] = fonts_.try_emplace(scale);
    if (is_new) {
        const auto add = [&](float size) {
            ImFontConfig config;
            config.SizePixels = size * static_cast<float>(scale);
            ImFont* const font = io.Fonts->AddFontDefault(&config);
            font->Scale = 1.0f / static_cast<float>(scale);
            return font;
        };
        fonts->second = {add(13.0f), add(26.0f)};
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
    std::tie(small_, large_) = fonts->second;
    io.FontDefault = small_;
    width_ = static_cast<float>(width) / static_cast<float>(scale);
    height_ = static_cast<float>(height) / static_cast<float>(scale);
    io.DisplaySize = ImVec2(width_, height_);
    io.DisplayFramebufferScale = ImVec2(static_cast<float>(scale), static_cast<float>(scale));
    io.DeltaTime = 1.0f / 30.0f;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void Hud::end() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Hud::draw(const Readout& readout, std::span<const Tile> tiles, int width, int height) {
    const int scale = scale_of(width, height);
    begin(width, height, scale);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::vector<Tile> scaled;
    for (const Tile& tile : tiles) {
        scaled.push_back(downscaled(tile, scale));
        place_labels(scaled.back(), *small_);
        draw_tile(list, scaled.back(), tiles.size() > 1);
    }
    const int numbers_begin = list.VtxBuffer.Size;
    Gap gap{edge, width_ - edge, edge, height_ - above_titles};
    if (!scaled.empty()) {
        const Tile& first = scaled.front();
        first.width < least_tile_width || first.height < least_tile_height
            ? draw_strip(list, readout, gap)
            : draw_numbers(list, readout, first, gap);
    }
    if (readout.vital_signs) {
        draw_vital_signs(list, *readout.vital_signs, gap);
    }
    const int notice_begin = list.VtxBuffer.Size;
    draw_notice(list, readout, gap);
    const int alarms_begin = list.VtxBuffer.Size;
    draw_alarms(list, readout.alarms, scaled.empty() ? Tile{} : scaled.front(), gap);
    if (readout.link == ServerLink::lost) {
        dim(list, numbers_begin, notice_begin);
        dim(list, alarms_begin, list.VtxBuffer.Size);
    }
    if (readout.verdict) {
        draw_verdict(list, *readout.verdict, gap);
    }
    draw_keys(list, readout, gap);
    end();
}

void Hud::draw_eyes(std::span<Tile, 2> eyes, int width, int height) {
    // A lens spreads this picture over a field twice as wide as a screen of the same height.
    const int scale = height < 1500 ? 1 : 2;
    begin(width, height, scale);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::vector<Tile> scaled;
    for (const Tile& eye : eyes) {
        scaled.push_back(downscaled(eye, scale));
        place_labels(scaled.back(), *small_);
    }
    if (scaled[0].marks.size() == scaled[1].marks.size()) {
        for (std::size_t i = 0; i < scaled[0].marks.size(); ++i) {
            scaled[1].marks[i].label = scaled[0].marks[i].label;
        }
    }
    for (const Tile& eye : scaled) {
        draw_tile(list, eye, false);
    }
    end();
}

void Hud::draw_tile(ImDrawList& list, const Tile& tile, bool framed) const {
    const ImVec2 corner(static_cast<float>(tile.x), static_cast<float>(tile.y));
    const ImVec2 opposite(corner.x + static_cast<float>(tile.width),
                          corner.y + static_cast<float>(tile.height));
    list.PushClipRect(corner, opposite);
    draw_marks(list, tile, *small_);
    list.PopClipRect();
    if (framed) {
        list.AddRect(corner, opposite, IM_COL32(20, 24, 26, 255), 0.0f, 0, 2.0f);
    }
    if (tile.title.empty()) {
        return;
    }
    const ImVec2 size = ImGui::CalcTextSize(tile.title.data(), tile.title.data() + tile.title.size());
    const ImVec2 at(opposite.x - size.x - 8.0f, opposite.y - size.y - 6.0f);
    list.AddRectFilled(ImVec2(at.x - 4.0f, at.y - 2.0f), ImVec2(opposite.x - 4.0f, opposite.y - 4.0f), shade,
                       3.0f);
    list.AddText(at, grey, tile.title.data(), tile.title.data() + tile.title.size());
}

// At the bottom: messages of the server or the connection.
void Hud::draw_notice(ImDrawList& list, const Readout& readout, Gap& gap) const {
    std::string text;
    ImU32 colour = white;
    switch (readout.link) {
        case ServerLink::waiting:
            text = "waiting for the server";
            break;
        case ServerLink::lost:
            text = "server lost";
            colour = red;
            break;
        case ServerLink::finished:
            text = "session finished";
            colour = green;
            break;
        case ServerLink::running:
            text = readout.warning.empty() ? readout.message : readout.warning;
            colour = readout.warning.empty() ? white : red;
            break;
    }
    if (text.empty()) {
        return;
    }
    const bool shout = readout.link != ServerLink::running || !readout.warning.empty();
    ImFont* const font = shout ? large_ : small_;
    const float size = shout ? 26.0f : 13.0f, room = width_ - 32.0f;
    const ImVec2 extent = font->CalcTextSizeA(size, FLT_MAX, room, text.c_str());
    const ImVec2 at(0.5f * (width_ - extent.x), gap.bottom - extent.y);
    list.AddRectFilled(ImVec2(at.x - 8.0f, at.y - 5.0f),
                       ImVec2(at.x + extent.x + 8.0f, at.y + extent.y + 5.0f), shade, 4.0f);
    list.AddText(font, size, at, colour, text.c_str(), nullptr, room);
    gap.bottom = at.y - 5.0f - edge;
}

// Above the notice, the first lowest; centred in the first view if there is room at its bottom.
void Hud::draw_alarms(ImDrawList& list, std::span<const std::string> alarms, const Tile& first,
                      Gap& gap) const {
    constexpr float high = 30.0f;
    const auto tile_width = static_cast<float>(first.width);
    const bool reaches_down = static_cast<float>(first.y + first.height) >= height_ - 1.0f;
    for (const std::string& alarm : alarms) {
        const ImVec2 extent = large_->CalcTextSizeA(26.0f, FLT_MAX, 0.0f, alarm.c_str());
        const float room = reaches_down && extent.x + 2.0f * edge <= tile_width ? tile_width : width_;
        const ImVec2 at(std::max(edge, 0.5f * (room - extent.x)), gap.bottom - high);
        list.AddRectFilled(ImVec2(at.x - 8.0f, at.y), ImVec2(at.x + extent.x + 8.0f, at.y + high), shade,
                           4.0f);
        list.AddText(large_, 26.0f, ImVec2(at.x, at.y + 2.0f), red, alarm.c_str());
        gap.bottom = at.y - edge;
    }
}

// Left edge of a box of this width: centred in the picture, but beside the numbers if there is room.
float Hud::beside_numbers(float wide, const Gap& gap) const {
    const float middle = 0.5f * (width_ - wide);
    return gap.left + wide <= gap.right ? std::clamp(middle, gap.left, gap.right - wide) : middle;
}

// Its lower edge is above alarms and notice.
void Hud::draw_verdict(ImDrawList& list, const Verdict& verdict, const Gap& gap) const {
    std::vector<TextLine> lines{
        {.text = verdict.title, .value = {}, .colour = colour_of(verdict.level), .large = true},
        {.text = verdict.reason, .value = {}}};
    for (const auto& [label, value] : verdict.numbers) {
        lines.push_back({.text = label, .value = value, .colour = grey});
    }
    const float wide = std::min(panel_width, width_ - 2.0f * edge);
    const float high = text_box_height({small_, large_}, lines, wide);
    draw_text_box(list, {small_, large_}, lines,
                  ImVec2(beside_numbers(wide, gap), std::max(edge, gap.bottom - high)), wide);
}

// Help in the middle; the scenario and a notice at the top; guidance at the lower left.
void Hud::draw_keys(ImDrawList& list, const Readout& readout, const Gap& gap) const {
    const TextFonts fonts{small_, large_};
    const float wide = std::min(panel_width, width_ - 2.0f * edge);
    std::vector<TextLine> lines;
    for (const auto& [key, help] : readout.keys) {
        lines.push_back({.text = fmt::format("{:<6} {}", key, help), .value = {}});
    }
    if (!lines.empty()) {
        const float high = text_box_height(fonts, lines, wide);
        draw_text_box(list, fonts, lines,
                      ImVec2(beside_numbers(wide, gap), std::max(edge, 0.5f * (height_ - high))), wide);
    }
    std::vector<TextLine> top;
    if (!readout.description.empty()) {
        top.push_back({.text = readout.scenario, .value = {}});
        top.push_back({.text = readout.description, .value = {}, .colour = grey});
    }
    if (!readout.note.empty()) {
        top.push_back({.text = readout.note, .value = {}, .colour = blue, .large = true});
    }
    if (!readout.notice.empty()) {
        top.push_back({.text = readout.notice, .value = {}, .colour = amber});
    }
    if (!top.empty()) {
        // Narrower, to avoid the boxes in the corners.
        const float room = gap.right - gap.left;
        const float here = room >= 0.6f * panel_width ? std::min(wide, room) : wide;
        draw_text_box(list, fonts, top, ImVec2(beside_numbers(here, gap), gap.top), here);
    }
    // At the lower left, where no view shows its tools.
    std::vector<TextLine> guidance;
    for (const std::string& line : readout.guidance) {
        guidance.push_back({.text = line, .value = {}, .colour = guidance.empty() ? green : white});
    }
    if (!guidance.empty()) {
        const float narrow = std::min(guidance_width, wide);
        const float high = text_box_height(fonts, guidance, narrow);
        draw_text_box(list, fonts, guidance, ImVec2(edge, height_ - high - edge), narrow);
    }
}

}  // namespace eti::hud
