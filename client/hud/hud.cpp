// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/hud.hpp"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/hud/panel.hpp"

namespace eti::hud {
namespace {

constexpr float panel_width = 330.0f, guidance_width = 300.0f;
constexpr float below_numbers = 182.0f, counts_width = 176.0f;
constexpr float above_notice = 66.0f, alarm_height = 34.0f;

constexpr float gum_force_scale_n = 6.0f;  // full length of its bar

ImU32 colour_of(Level level) {
    switch (level) {
        case Level::bad:
            return red;
        case Level::warning:
            return amber;
        case Level::neutral:
            return white;
        case Level::good:
            break;
    }
    return green;
}

void draw_mark(ImDrawList& list, const Mark& mark) {
    const ImVec2 from(mark.from.x(), mark.from.y()), to(mark.to.x(), mark.to.y());
    if (mark.bare) {
        // Whoever gave it draws what it stands beside.
    } else if (mark.from == mark.to) {
        list.AddCircleFilled(from, 5.0f, colour_of(mark.level));
        list.AddCircle(from, 6.0f, IM_COL32(8, 12, 14, 255), 0, 1.5f);
    } else {
        list.AddLine(from, to, colour_of(mark.level), 2.0f);
    }
    if (!mark.text.empty()) {
        const ImVec2 size = ImGui::CalcTextSize(mark.text.c_str());
        const float x = mark.text_left ? to.x - 10.0f - size.x : to.x + 10.0f;
        const ImVec2 at(x, to.y - 0.5f * size.y);
        list.AddRectFilled(ImVec2(at.x - 3.0f, at.y - 1.0f),
                           ImVec2(at.x + size.x + 3.0f, at.y + size.y + 1.0f), shade, 3.0f);
        list.AddText(at, colour_of(mark.level), mark.text.c_str());
    }
}

void bar(ImDrawList& list, ImVec2 at, float width, float share, ImU32 colour) {
    const float filled = width * std::clamp(share, 0.0f, 1.0f);
    list.AddRectFilled(at, ImVec2(at.x + width, at.y + 8.0f), IM_COL32(60, 68, 72, 220), 2.0f);
    list.AddRectFilled(at, ImVec2(at.x + filled, at.y + 8.0f), colour, 2.0f);
}

// What was true when the server was last heard must not look as if it were true now.
void dim(ImDrawList& list, int from) {
    constexpr ImU32 opacity = 90;  // of 255
    for (int i = from; i < list.VtxBuffer.Size; ++i) {
        ImU32& colour = list.VtxBuffer[i].col;
        if (colour == shade) {
            continue;  // what is written stays readable before any picture
        }
        const ImU32 alpha = (colour >> IM_COL32_A_SHIFT & 0xffu) * opacity / 255u;
        colour = (colour & ~IM_COL32_A_MASK) | alpha << IM_COL32_A_SHIFT;
    }
}

std::string clock_text(double seconds) {
    return fmt::format("{:02d}:{:04.1f}", static_cast<int>(seconds) / 60,
                       seconds - 60.0 * (static_cast<int>(seconds) / 60));
}

}  // namespace

Hud::Hud() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    ImFontConfig config;
    config.SizePixels = 13.0f;
    small_ = io.Fonts->AddFontDefault(&config);
    config.SizePixels = 26.0f;
    large_ = io.Fonts->AddFontDefault(&config);
    if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
        ImGui::DestroyContext();
        throw std::runtime_error("the text overlay cannot be drawn with this OpenGL driver");
    }
}

Hud::~Hud() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void Hud::draw(const Readout& readout, std::span<const Tile> tiles, int width, int height) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
    io.DeltaTime = 1.0f / 30.0f;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const Tile& tile : tiles) {
        const ImVec2 corner(static_cast<float>(tile.x), static_cast<float>(tile.y));
        const ImVec2 end(corner.x + static_cast<float>(tile.width),
                         corner.y + static_cast<float>(tile.height));
        list.PushClipRect(corner, end);
        for (const Mark& mark : tile.marks) {
            draw_mark(list, mark);
        }
        list.PopClipRect();
        if (tiles.size() > 1) {
            list.AddRect(corner, end, IM_COL32(20, 24, 26, 255), 0.0f, 0, 2.0f);
        }
        if (tile.title.empty()) {
            continue;
        }
        const ImVec2 size = ImGui::CalcTextSize(tile.title.data(), tile.title.data() + tile.title.size());
        const ImVec2 at(end.x - size.x - 8.0f, end.y - size.y - 6.0f);
        list.AddRectFilled(ImVec2(at.x - 4.0f, at.y - 2.0f), ImVec2(end.x - 4.0f, end.y - 4.0f), shade, 3.0f);
        list.AddText(at, grey, tile.title.data(), tile.title.data() + tile.title.size());
    }
    const int numbers_begin = list.VtxBuffer.Size;
    if (!tiles.empty()) {
        draw_numbers(list, readout, tiles.front());
    }
    if (readout.vital_signs) {
        draw_vital_signs(list, *readout.vital_signs, width);
    }
    draw_counts(list, readout);
    draw_alarms(list, readout.alarms, width, height);
    if (readout.link == Link::lost) {
        dim(list, numbers_begin);
    }
    if (readout.verdict) {
        draw_verdict(list, *readout.verdict, width,
                     static_cast<float>(height) - above_notice -
                         alarm_height * static_cast<float>(readout.alarms.size()));
    }
    draw_keys(list, readout, width, height);
    draw_notice(list, readout, width, height);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Hud::draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile) const {
    const float left = static_cast<float>(tile.x) + 8.0f;
    float y = static_cast<float>(tile.y) + 8.0f;
    constexpr float column = 168.0f;
    list.AddRectFilled(ImVec2(left - 4.0f, y - 4.0f), ImVec2(left + column + 4.0f, y + 166.0f), shade, 4.0f);
    const std::string clock = clock_text(readout.time_s);
    list.AddText(large_, 26.0f, ImVec2(left, y), white, clock.c_str());
    const std::string attempt = readout.attempt == 0 ? std::string("no attempt yet")
                                                     : fmt::format("attempt {}{}", readout.attempt,
                                                                   readout.attempt_running ? "" : " ended");
    list.AddText(ImVec2(left, y + 28.0f), readout.attempt_running ? green : grey, attempt.c_str());
    y += 46.0f;
    const auto line = [&](const std::string& text, ImU32 colour) {
        list.AddText(small_, 13.0f, ImVec2(left, y), colour, text.c_str());
        y += 15.0f;
    };
    line(fmt::format("gum force   {:5.1f} N", readout.gum_force_n), white);
    bar(list, ImVec2(left, y), column, readout.gum_force_n / gum_force_scale_n,
        colour_of(gum_force_level(readout.gum_force_n)));
    y += 13.0f;
    line(fmt::format("glottis seen {:4.0f} %", readout.glottic_opening_percent), white);
    bar(list, ImVec2(left, y), column, readout.glottic_opening_percent / 100.0f, green);
    y += 13.0f;
    line(readout.blade_depth_cm > 0.0f ? fmt::format("blade depth {:5.1f} cm", readout.blade_depth_cm)
                                       : std::string("blade outside"),
         white);
    line(readout.tube_past_cords_cm > 0.0f
             ? fmt::format("tube {:4.1f} cm past cords", readout.tube_past_cords_cm)
             : std::string("tube before cords"),
         white);
    line(fmt::format("tube force  {:5.2f} N", readout.tube_force_n), white);
    const bool late = readout.behind_s > 0.5f;
    line(late ? fmt::format("server {:.0f} %, {:.0f} s late", 100.0f * readout.server_load, readout.behind_s)
              : fmt::format("server {:3.0f} %", 100.0f * readout.server_load),
         late ? amber : grey);
}

// As a monitor has them, at the right.
void Hud::draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, int width) const {
    constexpr float wide = 124.0f, high = 78.0f, label = 12.0f, number = 26.0f;
    const ImVec2 corner(static_cast<float>(width) - wide - 4.0f, 4.0f);
    list.AddRectFilled(corner, ImVec2(corner.x + wide, corner.y + high), shade, 4.0f);
    float y = corner.y + 6.0f;
    const auto line = [&](const char* name, double value, Level level) {
        const std::string text = fmt::format("{:3.0f}", value);
        list.AddText(small_, 13.0f, ImVec2(corner.x + 8.0f, y + label), grey, name);
        list.AddText(large_, number, ImVec2(corner.x + 74.0f, y), colour_of(level), text.c_str());
        y += number + 8.0f;
    };
    line("SpO2 %", signs.oxygen_saturation_percent, saturation_level(signs.oxygen_saturation_percent));
    line("HR /min", signs.heart_rate_per_min, heart_rate_level(signs.heart_rate_per_min));
}

void Hud::draw_counts(ImDrawList& list, const Readout& readout) const {
    std::vector<PanelLine> lines;
    if (const auto& clock = readout.clock) {
        lines.push_back({.text = fmt::format("{:.1f}/{:.0f} s", clock->time_s, clock->limit_s),
                         .value = {},
                         .colour = colour_of(clock->level()),
                         .large = true});
    }
    if (const auto& depth = readout.tube_depth) {
        lines.push_back({.text = "tube at the lip",
                         .value = fmt::format("{:.1f} cm", depth->at_lip_cm),
                         .colour = colour_of(depth->level())});
        lines.push_back(
            {.text = "by the rule", .value = fmt::format("{:.1f} cm", depth->rule_cm), .colour = grey});
    }
    if (!lines.empty()) {
        draw_panel(list, {small_, large_}, lines, ImVec2(4.0f, below_numbers), counts_width);
    }
}

// Above the notice, in the middle, the first lowest.
void Hud::draw_alarms(ImDrawList& list, std::span<const std::string> alarms, int width, int height) const {
    float y = static_cast<float>(height) - above_notice - alarm_height;
    for (const std::string& alarm : alarms) {
        const ImVec2 extent = large_->CalcTextSizeA(26.0f, static_cast<float>(width), 0.0f, alarm.c_str());
        const ImVec2 at(std::max(4.0f, 0.5f * (static_cast<float>(width) - extent.x)), y);
        list.AddRectFilled(ImVec2(at.x - 8.0f, at.y), ImVec2(at.x + extent.x + 8.0f, at.y + 30.0f), shade,
                           4.0f);
        list.AddText(large_, 26.0f, ImVec2(at.x, at.y + 2.0f), red, alarm.c_str());
        y -= alarm_height;
    }
}

// Its lower edge at `bottom`, in the middle.
void Hud::draw_verdict(ImDrawList& list, const Verdict& verdict, int width, float bottom) const {
    std::vector<PanelLine> lines{
        {.text = verdict.title, .value = {}, .colour = verdict.success ? green : red, .large = true},
        {.text = verdict.reason, .value = {}}};
    for (const auto& [label, value] : verdict.numbers) {
        lines.push_back({.text = label, .value = value, .colour = grey});
    }
    const float wide = std::min(panel_width, static_cast<float>(width) - 8.0f);
    const float high = panel_height({small_, large_}, lines, wide);
    draw_panel(list, {small_, large_}, lines,
               ImVec2(0.5f * (static_cast<float>(width) - wide), std::max(4.0f, bottom - high)), wide);
}

// Help in the middle; the scenario and a notice at the top; guidance at the lower left.
void Hud::draw_keys(ImDrawList& list, const Readout& readout, int width, int height) const {
    const PanelFonts fonts{small_, large_};
    const float wide = std::min(panel_width, static_cast<float>(width) - 8.0f);
    const float left = 0.5f * (static_cast<float>(width) - wide);
    std::vector<PanelLine> lines;
    for (const auto& [key, help] : readout.keys) {
        lines.push_back({.text = fmt::format("{:<6} {}", key, help), .value = {}});
    }
    if (!lines.empty()) {
        const float high = panel_height(fonts, lines, wide);
        draw_panel(list, fonts, lines,
                   ImVec2(left, std::max(4.0f, 0.5f * (static_cast<float>(height) - high))), wide);
    }
    std::vector<PanelLine> top;
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
        draw_panel(list, fonts, top, ImVec2(left, 4.0f), wide);
    }
    // At the lower left, where no view has its tools.
    std::vector<PanelLine> guidance;
    for (const std::string& line : readout.guidance) {
        guidance.push_back({.text = line, .value = {}, .colour = guidance.empty() ? green : white});
    }
    if (!guidance.empty()) {
        const float narrow = std::min(guidance_width, wide);
        const float high = panel_height(fonts, guidance, narrow);
        draw_panel(list, fonts, guidance, ImVec2(4.0f, static_cast<float>(height) - high - 4.0f), narrow);
    }
}

void Hud::draw_notice(ImDrawList& list, const Readout& readout, int width, int height) const {
    std::string text;
    ImU32 colour = white;
    switch (readout.link) {
        case Link::waiting:
            text = "waiting for the server";
            break;
        case Link::lost:
            text = "server lost";
            colour = red;
            break;
        case Link::finished:
            text = "session finished";
            colour = green;
            break;
        case Link::running:
            text = readout.warning.empty() ? readout.message : readout.warning;
            colour = readout.warning.empty() ? white : red;
            break;
    }
    if (text.empty()) {
        return;
    }
    const bool shout = readout.link != Link::running || !readout.warning.empty();
    ImFont* const font = shout ? large_ : small_;
    const float size = shout ? 26.0f : 13.0f;
    const ImVec2 extent = font->CalcTextSizeA(size, static_cast<float>(width), 0.0f, text.c_str());
    const ImVec2 at(std::max(4.0f, 0.5f * (static_cast<float>(width) - extent.x)),
                    static_cast<float>(height) - extent.y - 24.0f);
    list.AddRectFilled(ImVec2(at.x - 8.0f, at.y - 5.0f),
                       ImVec2(at.x + extent.x + 8.0f, at.y + extent.y + 5.0f), shade, 4.0f);
    list.AddText(font, size, at, colour, text.c_str());
}

}  // namespace eti::hud
