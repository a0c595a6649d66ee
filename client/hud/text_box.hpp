// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <imgui.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "client/hud/readout.hpp"

namespace eti::hud {

// Every colour but `rail` is for text on `shade`: at least 4.5:1 by WCAG 2.1 whatever lies beneath it.
constexpr ImU32 white = IM_COL32(240, 244, 246, 255);
constexpr ImU32 grey = IM_COL32(176, 186, 192, 255);
constexpr ImU32 amber = IM_COL32(245, 178, 60, 255);
constexpr ImU32 red = IM_COL32(255, 116, 102, 255);
constexpr ImU32 green = IM_COL32(96, 208, 140, 255);
constexpr ImU32 blue = IM_COL32(120, 186, 255, 255);      // also of marks
constexpr ImU32 outdated = IM_COL32(150, 158, 164, 255);  // values of a lost server
constexpr ImU32 shade = IM_COL32(8, 12, 14, 228);
constexpr ImU32 opaque_shade = IM_COL32(8, 12, 14, 255);
constexpr ImU32 rail = IM_COL32(60, 68, 72, 255);  // of bars

[[nodiscard]] ImU32 colour_of(Level level);

/// Letter height [pixels], as drawn.
[[nodiscard]] float height_of(const ImFont& font);

/// Letters of two sizes. Lengths of the layout are in thirteenths of the small letters' height.
struct TextFonts {
    ImFont* small;
    ImFont* large;

    /// Whole pixels of a length.
    [[nodiscard]] float px(float units) const { return std::round(units * height_of(*small) / 13.0f); }
};

/// A line of text, or a row of two columns.
struct TextLine {
    std::string text;
    std::string value;  ///< right-aligned; empty: the text uses the whole width and wraps
    ImU32 colour = white;
    bool large = false;
    std::optional<Level> sign{};  ///< drawn before the text, or before the value if there is one
};

/// A level as a shape: a circle, a triangle or a square, as in the report; nothing for a neutral one.
void draw_sign(ImDrawList& list, Level level, ImVec2 centre, float radius);
/// Width of a sign with the space behind it [pixels].
[[nodiscard]] float sign_width(const TextFonts& fonts, bool large);

/// Width and height [pixels] of a text that wraps at `room`.
[[nodiscard]] ImVec2 text_extent(const ImFont& font, const std::string& text, float room);

/// Width [pixels] of a box in which no line wraps, including its margins.
[[nodiscard]] float text_box_width(const TextFonts& fonts, std::span<const TextLine> lines);
/// Height [pixels] of a box `width` wide, including its margin.
[[nodiscard]] float text_box_height(const TextFonts& fonts, std::span<const TextLine> lines, float width);

/// Draws lines one below the other on a shaded box with its upper left at `corner`.
void draw_text_box(ImDrawList& list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                   float width);

/// Draws one line, or row, without a box; returns its height [pixels]. Draws nothing if `list` is null.
float draw_text_line(ImDrawList* list, const TextFonts& fonts, const TextLine& line, ImVec2 at, float width);

/// Places lines one after the other in rows of the width `room`; a line that is wider wraps in rows of its
/// own. Draws them from `corner` on if `list` is not null. Returns the height [pixels].
float flow_text(ImDrawList* list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                float room);

}  // namespace eti::hud
