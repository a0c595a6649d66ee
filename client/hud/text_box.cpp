// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/text_box.hpp"

#include <cfloat>

namespace eti::hud {
namespace {

constexpr float panel_margin = 10.0f;
constexpr float gap = 3.0f;

struct Font {
    ImFont* font;
    float size;
};

Font font_of(const TextFonts& fonts, const TextLine& line) {
    ImFont* const font = line.large ? fonts.large : fonts.small;
    return {font, height_of(*font)};
}

// Wrapped at the panel's inner width. Passing that as the maximum width too would stop the measurement at a
// line that fills it.
ImVec2 extent(const Font& font, const TextLine& line, float inner) {
    return font.font->CalcTextSizeA(font.size, FLT_MAX, inner, line.text.c_str());
}

}  // namespace

ImU32 colour_of(Level level) {
    switch (level) {
        case Level::good:
            return green;
        case Level::warning:
            return amber;
        case Level::bad:
            return red;
        case Level::neutral:
            break;
    }
    return white;
}

float height_of(const ImFont& font) {
    return font.Scale * font.FontSize;
}

float text_box_height(const TextFonts& fonts, std::span<const TextLine> lines, float width) {
    float height = 2.0f * panel_margin - gap;
    for (const TextLine& line : lines) {
        height += extent(font_of(fonts, line), line, width - 2.0f * panel_margin).y + gap;
    }
    return height;
}

void draw_text_box(ImDrawList& list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                   float width) {
    const float inner = width - 2.0f * panel_margin;
    list.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + text_box_height(fonts, lines, width)),
                       IM_COL32(8, 12, 14, 200), 4.0f);
    ImVec2 at(corner.x + panel_margin, corner.y + panel_margin);
    for (const TextLine& line : lines) {
        const Font font = font_of(fonts, line);
        list.AddText(font.font, font.size, at, line.colour, line.text.c_str(), nullptr, inner);
        if (!line.value.empty()) {
            const float length = font.font->CalcTextSizeA(font.size, inner, 0.0f, line.value.c_str()).x;
            list.AddText(font.font, font.size, ImVec2(at.x + inner - length, at.y), line.colour,
                         line.value.c_str());
        }
        at.y += extent(font, line, inner).y + gap;
    }
}

}  // namespace eti::hud
