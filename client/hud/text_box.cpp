// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/text_box.hpp"

#include <algorithm>
#include <cfloat>
#include <vector>

namespace eti::hud {
namespace {

// In thirteenths of the letters' height.
constexpr float box_margin = 9.0f, line_gap = 2.0f, column_gap = 10.0f, flow_gap = 16.0f,
                corner_radius = 4.0f;

ImFont& font_of(const TextFonts& fonts, const TextLine& line) {
    return line.large ? *fonts.large : *fonts.small;
}

// What a line leaves for its text at a width.
struct LineShape {
    float sign = 0.0f, value = 0.0f, text = 0.0f;  // widths
    ImVec2 extent;                                 // of the text
};

LineShape shape_of(const TextFonts& fonts, const TextLine& line, float width) {
    const ImFont& font = font_of(fonts, line);
    LineShape out;
    out.sign = line.sign && *line.sign != Level::neutral ? sign_width(fonts, line.large) : 0.0f;
    if (!line.value.empty()) {
        out.value = text_extent(font, line.value, FLT_MAX).x;
    }
    out.text = width - out.sign - (line.value.empty() ? 0.0f : out.value + fonts.px(column_gap));
    out.extent = text_extent(font, line.text, std::max(out.text, height_of(font)));
    return out;
}

void draw_line(ImDrawList& list, const TextFonts& fonts, const TextLine& line, const LineShape& shape,
               ImVec2 at, float width) {
    ImFont& font = font_of(fonts, line);
    const float size = height_of(font), radius = 0.3f * size;
    float x = at.x;
    if (line.sign) {
        const float sign_x = line.value.empty() ? x : x + width - shape.value - shape.sign;
        draw_sign(list, *line.sign, ImVec2(std::round(sign_x + radius), at.y + 0.52f * size), radius);
        x += line.value.empty() ? shape.sign : 0.0f;
    }
    list.AddText(&font, size, ImVec2(x, at.y), line.colour, line.text.c_str(), nullptr,
                 std::max(shape.text, size));
    if (!line.value.empty()) {
        list.AddText(&font, size, ImVec2(std::floor(at.x + width - shape.value), at.y), line.colour,
                     line.value.c_str());
    }
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

void draw_sign(ImDrawList& list, Level level, ImVec2 centre, float radius) {
    const ImU32 colour = colour_of(level);
    switch (level) {
        case Level::good:
            list.AddCircleFilled(centre, radius, colour);
            break;
        case Level::warning: {
            const float half = 1.1f * radius;
            list.AddTriangleFilled(ImVec2(centre.x, centre.y - half),
                                   ImVec2(centre.x + half, centre.y + half),
                                   ImVec2(centre.x - half, centre.y + half), colour);
            break;
        }
        case Level::bad: {
            const float half = 0.9f * radius;
            list.AddRectFilled(ImVec2(centre.x - half, centre.y - half),
                               ImVec2(centre.x + half, centre.y + half), colour);
            break;
        }
        case Level::neutral:
            break;
    }
}

float sign_width(const TextFonts& fonts, bool large) {
    return std::round(0.9f * height_of(large ? *fonts.large : *fonts.small));
}

// Passing the room as the maximum width too would stop the measurement at a line that fills it.
ImVec2 text_extent(const ImFont& font, const std::string& text, float room) {
    const ImVec2 size =
        font.CalcTextSizeA(height_of(font), FLT_MAX, room < FLT_MAX ? room : 0.0f, text.c_str());
    return {std::ceil(size.x), std::ceil(size.y)};
}

float text_box_width(const TextFonts& fonts, std::span<const TextLine> lines) {
    float width = 0.0f;
    for (const TextLine& line : lines) {
        const LineShape shape = shape_of(fonts, line, 0.0f);
        width = std::max(width, text_extent(font_of(fonts, line), line.text, FLT_MAX).x - shape.text);
    }
    return width + 2.0f * fonts.px(box_margin);
}

float text_box_height(const TextFonts& fonts, std::span<const TextLine> lines, float width) {
    const float inner = width - 2.0f * fonts.px(box_margin), gap = fonts.px(line_gap);
    float height = 2.0f * fonts.px(box_margin) - gap;
    for (const TextLine& line : lines) {
        height += shape_of(fonts, line, inner).extent.y + gap;
    }
    return height;
}

void draw_text_box(ImDrawList& list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                   float width) {
    const float margin = fonts.px(box_margin), inner = width - 2.0f * margin;
    list.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + text_box_height(fonts, lines, width)),
                       shade, fonts.px(corner_radius));
    ImVec2 at(corner.x + margin, corner.y + margin);
    for (const TextLine& line : lines) {
        const LineShape shape = shape_of(fonts, line, inner);
        draw_line(list, fonts, line, shape, at, inner);
        at.y += shape.extent.y + fonts.px(line_gap);
    }
}

float draw_text_line(ImDrawList* list, const TextFonts& fonts, const TextLine& line, ImVec2 at, float width) {
    const LineShape shape = shape_of(fonts, line, width);
    if (list != nullptr) {
        draw_line(*list, fonts, line, shape, at, width);
    }
    return shape.extent.y;
}

float flow_text(ImDrawList* list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                float room) {
    const float gap = fonts.px(flow_gap), between_rows = fonts.px(line_gap);
    std::vector<ImVec2> places;
    std::vector<float> widths;
    float x = 0.0f, y = 0.0f, row = 0.0f;
    std::size_t row_begin = 0;
    // Small letters of a row stand in the middle of its large ones.
    const auto end_row = [&] {
        for (std::size_t i = row_begin; i < places.size(); ++i) {
            const float high = shape_of(fonts, lines[i], widths[i]).extent.y;
            places[i].y = std::round(y + 0.5f * (row - high));
        }
        row_begin = places.size();
        y += row + between_rows;
        x = row = 0.0f;
    };
    for (const TextLine& line : lines) {
        const float natural = text_box_width(fonts, {&line, 1}) - 2.0f * fonts.px(box_margin);
        if (x > 0.0f && x + natural > room) {
            end_row();
        }
        widths.push_back(std::min(natural, room));
        places.emplace_back(x, y);
        row = std::max(row, shape_of(fonts, line, widths.back()).extent.y);
        x += widths.back() + gap;
    }
    end_row();
    for (std::size_t i = 0; list != nullptr && i < lines.size(); ++i) {
        draw_line(*list, fonts, lines[i], shape_of(fonts, lines[i], widths[i]),
                  ImVec2(corner.x + places[i].x, corner.y + places[i].y), widths[i]);
    }
    return y - between_rows;
}

}  // namespace eti::hud
