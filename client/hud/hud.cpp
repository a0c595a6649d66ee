// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/hud.hpp"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/hud/letters.hpp"
#include "client/text/catalogue.hpp"

namespace eti::hud {
namespace {

// In thirteenths of the letters' height.
constexpr float panel_width = 330.0f, guidance_width = 300.0f, box_corner = 4.0f;
constexpr float least_tile_width = 400.0f,
                least_tile_height = 230.0f;            // the numbers would cover half of a smaller tile
constexpr int least_letters = 13, most_letters = 160;  // [pixels]
constexpr std::size_t most_fonts = 6;                  // in the atlas at once, of different heights

// Shows values of a lost server in grey, so that they do not look current.
void fade(ImDrawList& list, int from, int to) {
    for (int i = from; i < to; ++i) {
        ImU32& colour = list.VtxBuffer[i].col;
        // The backing at a rounded corner's antialiasing has its colour at less opacity.
        if ((colour & ~IM_COL32_A_MASK) != (shade & ~IM_COL32_A_MASK) && colour != rail) {
            colour = (outdated & ~IM_COL32_A_MASK) | (colour & IM_COL32_A_MASK);
        }
    }
}

}  // namespace

int letter_height(int width, int height, float text_scale) {
    const float usual =
        std::max(static_cast<float>(std::min(width, height)) / 40.0f, static_cast<float>(least_letters));
    return std::min(static_cast<int>(std::lround(text_scale * usual)), most_letters);
}

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
    report_missing_letters();
}

Hud::~Hud() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void Hud::begin(int width, int height, int letters) {
    ImGuiIO& io = ImGui::GetIO();
    if (!fonts_by_height_.contains(letters)) {
        // A window that is being resized passes through many heights.
        if (fonts_by_height_.size() == most_fonts) {
            fonts_by_height_.clear();
            io.Fonts->Clear();
        }
        fonts_by_height_[letters] = {add_letters(*io.Fonts, letters), add_letters(*io.Fonts, 2 * letters)};
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
    fonts_ = fonts_by_height_[letters];
    io.FontDefault = fonts_.small;
    width_ = static_cast<float>(width);
    height_ = static_cast<float>(height);
    io.DisplaySize = ImVec2(width_, height_);
    io.DisplayFramebufferScale = ImVec2(1.0f, 1.0f);
    io.DeltaTime = 1.0f / 30.0f;
    boxes_.clear();
    verdict_box_.reset();
    numbers_bottom_ = 0.0f;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void Hud::end() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Hud::add_backing(ImDrawList& list, ImVec2 low, ImVec2 high) {
    list.AddRectFilled(low, high, shade, fonts_.px(box_corner));
    boxes_.push_back({{low.x, low.y}, {high.x, high.y}});
}

void Hud::add_box(ImDrawList& list, std::span<const TextLine> lines, ImVec2 corner, float width) {
    draw_text_box(list, fonts_, lines, corner, width);
    boxes_.push_back(
        {{corner.x, corner.y}, {corner.x + width, corner.y + text_box_height(fonts_, lines, width)}});
}

void Hud::draw(const Readout& readout, std::span<const Tile> tiles, int width, int height) {
    begin(width, height, letter_height(width, height, text_scale_));
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    // Boxes are laid out first, as labels keep clear of them, but lie above the marks.
    list.ChannelsSplit(2);
    list.ChannelsSetCurrent(1);
    const Tile first = tiles.empty() ? Tile{} : tiles.front();
    for (const Tile& tile : tiles) {
        draw_title(list, tile);
    }
    const int numbers_begin = list.VtxBuffer.Size;
    Gap gap{edge(), width_ - edge(), edge(), height_ - fonts_.px(24.0f)};  // above the tiles' titles
    const bool helping = !readout.keys.empty();  // alone with alarms and notices, which it must not hide
    if (!tiles.empty() && !helping) {
        static_cast<float>(first.width) < fonts_.px(least_tile_width) ||
                static_cast<float>(first.height) < fonts_.px(least_tile_height)
            ? draw_strip(list, readout, gap)
            : draw_numbers(list, readout, first, gap);
    }
    if (readout.vital_signs && !helping) {
        draw_vital_signs(list, *readout.vital_signs, gap);
    }
    const int notice_begin = list.VtxBuffer.Size;
    if (readout.verdict && !helping) {
        draw_verdict(list, readout, gap);
    } else {
        draw_notice(list, readout, gap);
    }
    const int alarms_begin = list.VtxBuffer.Size;
    draw_alarms(list, readout.alarms, first, gap);
    if (readout.link == ServerLink::lost) {
        fade(list, numbers_begin, notice_begin);
        fade(list, alarms_begin, list.VtxBuffer.Size);
    }
    if (helping) {
        draw_help(list, readout, gap);
    } else {
        draw_guidance(list, readout, gap);
        draw_top(list, readout, gap);
    }
    list.ChannelsSetCurrent(0);
    for (Tile tile : tiles) {
        place_labels(tile, *fonts_.small, boxes_);
        draw_tile(list, tile, tiles.size() > 1);
    }
    list.ChannelsMerge();
    end();
}

void Hud::draw_eyes(std::span<Tile, 2> eyes, int width, int height) {
    // A lens spreads this picture over a field twice as wide as a screen of the same height.
    begin(width, height,
          std::max(least_letters,
                   static_cast<int>(std::lround(text_scale_ * static_cast<float>(height) / 64.0f))));
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::array<Tile, 2> placed{eyes[0], eyes[1]};
    for (Tile& eye : placed) {
        place_labels(eye, *fonts_.small);
    }
    if (placed[0].marks.size() == placed[1].marks.size()) {
        for (std::size_t i = 0; i < placed[0].marks.size(); ++i) {
            placed[1].marks[i].label = placed[0].marks[i].label;
        }
    }
    for (const Tile& eye : placed) {
        draw_tile(list, eye, false);
    }
    end();
}

void Hud::draw_tile(ImDrawList& list, const Tile& tile, bool framed) const {
    const ImVec2 corner(static_cast<float>(tile.x), static_cast<float>(tile.y));
    const ImVec2 opposite(corner.x + static_cast<float>(tile.width),
                          corner.y + static_cast<float>(tile.height));
    list.PushClipRect(corner, opposite);
    draw_marks(list, tile, *fonts_.small);
    list.PopClipRect();
    if (framed) {
        list.AddRect(corner, opposite, IM_COL32(20, 24, 26, 255), 0.0f, 0, 2.0f);
    }
}

// In the lower right corner of its tile.
void Hud::draw_title(ImDrawList& list, const Tile& tile) {
    if (tile.title.empty()) {
        return;
    }
    const std::string title =
        tile.magnification > 1.0f
            ? text::translate_format("{}, loupe {:.1f} x", text::translate(tile.title), tile.magnification)
            : std::string(text::translate(tile.title));
    const ImVec2 size = text_extent(*fonts_.small, title, FLT_MAX);
    const float beyond = fonts_.px(4.0f);
    const ImVec2 low(static_cast<float>(tile.x + tile.width) - size.x - 3.0f * beyond,
                     static_cast<float>(tile.y + tile.height) - size.y - 2.0f * beyond);
    add_backing(list, low, ImVec2(low.x + size.x + 2.0f * beyond, low.y + size.y + beyond));
    list.AddText(fonts_.small, height_of(*fonts_.small), ImVec2(low.x + beyond, low.y + 0.5f * beyond), grey,
                 title.c_str());
}

// Messages of the server or the connection.
TextLine Hud::notice_line(const Readout& readout) {
    TextLine line{.text = {}, .value = {}, .large = true};
    switch (readout.link) {
        case ServerLink::waiting:
            line.text = text::translate("waiting for the server");
            break;
        case ServerLink::lost:
            line.text = text::translate("server lost");
            line.colour = red;
            line.sign = Level::bad;
            break;
        case ServerLink::finished:
            line.text = text::translate("session finished");
            line.colour = green;
            break;
        case ServerLink::running:
            line.large = !readout.warning.empty();
            line.text = line.large ? readout.warning : readout.message;
            line.colour = line.large ? red : white;
            line.sign = line.large ? std::optional(Level::bad) : std::nullopt;
            break;
    }
    return line;
}

// At the bottom.
void Hud::draw_notice(ImDrawList& list, const Readout& readout, Gap& gap) {
    const TextLine line = notice_line(readout);
    if (line.text.empty()) {
        return;
    }
    const float wide = std::min(text_box_width(fonts_, {&line, 1}), width_ - 2.0f * edge());
    const float high = text_box_height(fonts_, {&line, 1}, wide);
    add_box(list, {&line, 1}, ImVec2(std::floor(0.5f * (width_ - wide)), gap.bottom - high), wide);
    gap.bottom -= high + edge();
}

// Above the notice, the first lowest; centred in the first view if there is room at its bottom.
void Hud::draw_alarms(ImDrawList& list, std::span<const std::string> alarms, const Tile& first, Gap& gap) {
    const auto tile_width = static_cast<float>(first.width);
    const bool reaches_down = static_cast<float>(first.y + first.height) >= height_ - 1.0f;
    for (const std::string& alarm : alarms) {
        const TextLine line{.text = alarm, .value = {}, .colour = red, .large = true, .sign = Level::bad};
        const float natural = text_box_width(fonts_, {&line, 1});
        const float room = reaches_down && natural + 2.0f * edge() <= tile_width ? tile_width : width_;
        const float wide = std::min(natural, room - 2.0f * edge());
        const float high = text_box_height(fonts_, {&line, 1}, wide);
        add_box(list, {&line, 1}, ImVec2(std::floor(0.5f * (room - wide)), gap.bottom - high), wide);
        gap.bottom -= high + edge();
    }
}

// Left edge of a box of this width: centred in the picture, but beside the numbers if there is room.
float Hud::beside_numbers(float wide, const Gap& gap) const {
    const float middle = 0.5f * (width_ - wide);
    return std::floor(gap.left + wide <= gap.right ? std::clamp(middle, gap.left, gap.right - wide) : middle);
}

// A band along the lower edge, with the notice in it: the face is in the middle of every view.
void Hud::draw_verdict(ImDrawList& list, const Readout& readout, Gap& gap) {
    const Verdict& verdict = *readout.verdict;
    std::vector<TextLine> lines{{.text = verdict.title,
                                 .value = {},
                                 .colour = colour_of(verdict.level),
                                 .large = true,
                                 .sign = verdict.level},
                                {.text = verdict.reason, .value = {}}};
    // The newest message only says that the attempt has ended.
    if (readout.link != ServerLink::running || !readout.warning.empty()) {
        lines.push_back(notice_line(readout));
        lines.back().large = false;
    }
    for (const auto& [label, value] : verdict.numbers) {
        lines.push_back({.text = label + " " + value, .value = {}, .colour = grey});
    }
    const float margin = fonts_.px(7.0f), wide = width_ - 2.0f * edge(), room = wide - 2.0f * margin;
    const float high = flow_text(nullptr, fonts_, lines, {}, room) + 2.0f * margin;
    const ImVec2 corner(edge(), gap.bottom - high);
    add_backing(list, corner, ImVec2(corner.x + wide, gap.bottom));
    verdict_box_ = boxes_.back();
    flow_text(&list, fonts_, lines, ImVec2(corner.x + margin, corner.y + margin), room);
    gap.bottom = corner.y - edge();
}

// At the lower left, where no view shows its tools.
void Hud::draw_guidance(ImDrawList& list, const Readout& readout, const Gap& gap) {
    std::vector<TextLine> lines;
    for (const std::string& line : readout.guidance) {
        lines.push_back({.text = line, .value = {}, .colour = lines.empty() ? green : white});
    }
    if (lines.empty()) {
        return;
    }
    const float wide = std::min(fonts_.px(guidance_width), width_ - 2.0f * edge());
    const float high = text_box_height(fonts_, lines, wide);
    const float top = std::max(edge(), gap.bottom - high);
    // Beside the numbers where it would reach up to them.
    const bool beside = top < numbers_bottom_ + edge() && gap.left + wide <= width_ - edge();
    add_box(list, lines, ImVec2(beside ? gap.left : edge(), top), wide);
}

// The scenario, remarks and notices at the top.
void Hud::draw_top(ImDrawList& list, const Readout& readout, const Gap& gap) {
    std::vector<TextLine> lines;
    if (!readout.description.empty()) {
        lines.push_back({.text = readout.scenario, .value = {}});
        lines.push_back({.text = readout.description, .value = {}, .colour = grey});
    }
    if (!readout.note.empty()) {
        lines.push_back({.text = readout.note, .value = {}, .colour = blue, .large = true});
    }
    if (!readout.notice.empty()) {
        lines.push_back({.text = readout.notice, .value = {}, .colour = amber});
    }
    if (lines.empty()) {
        return;
    }
    // Narrower, to avoid the boxes in the corners.
    const float usual = std::min(fonts_.px(panel_width), width_ - 2.0f * edge());
    const float room = gap.right - gap.left;
    const float wide = room >= 0.6f * fonts_.px(panel_width) ? std::min(usual, room) : usual;
    add_box(list, lines, ImVec2(beside_numbers(wide, gap), gap.top), wide);
}

// In as many columns as fit; in smaller letters if the picture is too small for all keys.
void Hud::draw_help(ImDrawList& list, const Readout& readout, const Gap& gap) {
    ImFont& font = *fonts_.small;
    struct Cell {
        int column;
        float y, high;
    };
    for (const float smaller : {1.0f, 0.85f, 0.72f, 0.6f, 0.5f}) {
        const float size = smaller * height_of(font), margin = std::round(0.7f * size);
        const auto extent = [&](const std::string& words, float room) {
            return font.CalcTextSizeA(size, FLT_MAX, room, words.c_str());
        };
        float captions = 0.0f;
        for (const auto& [key, help] : readout.keys) {
            captions = std::max(captions, extent(key, 0.0f).x);
        }
        captions += 0.8f * size;
        for (int columns = 1; columns <= 4; ++columns) {
            const float whole = width_ - 2.0f * edge() - margin;
            const float cell = std::min(whole / static_cast<float>(columns), captions + 22.0f * size);
            const float room = cell - captions - margin;
            if (room < 8.0f * size) {
                break;
            }
            const float most = gap.bottom - edge() - 2.0f * margin;
            std::vector<Cell> cells;
            float y = 0.0f, lowest = 0.0f;
            int column = 0;
            for (const auto& [key, help] : readout.keys) {
                const float high = std::max(extent(help, room).y, size) + 0.15f * size;
                if (y > 0.0f && y + high > most) {
                    ++column;
                    y = 0.0f;
                }
                cells.push_back({column, y, high});
                y += high;
                lowest = std::max(lowest, y);
            }
            const bool last_try = smaller == 0.5f && columns == 4;
            if (column >= columns && !last_try) {
                continue;
            }
            const float wide = static_cast<float>(column + 1) * cell + margin, high = lowest + 2.0f * margin;
            const ImVec2 corner(std::floor(std::max(edge(), 0.5f * (width_ - wide))),
                                std::floor(std::max(edge(), 0.5f * (gap.bottom - high))));
            list.AddRectFilled(corner, ImVec2(corner.x + wide, corner.y + high), opaque_shade,
                               fonts_.px(box_corner));
            boxes_.push_back({{corner.x, corner.y}, {corner.x + wide, corner.y + high}});
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const ImVec2 at(std::floor(corner.x + margin + static_cast<float>(cells[i].column) * cell),
                                std::floor(corner.y + margin + cells[i].y));
                list.AddText(&font, size, at, white, readout.keys[i].first.c_str());
                list.AddText(&font, size, ImVec2(std::floor(at.x + captions), at.y), grey,
                             readout.keys[i].second.c_str(), nullptr, room);
            }
            return;
        }
    }
}

}  // namespace eti::hud
