// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <imgui.h>

#include <span>
#include <string>

#include "client/hud/readout.hpp"

namespace eti::hud {

constexpr ImU32 white = IM_COL32(240, 244, 246, 255);
constexpr ImU32 grey = IM_COL32(168, 178, 184, 255);
constexpr ImU32 amber = IM_COL32(245, 178, 60, 255);
constexpr ImU32 red = IM_COL32(240, 84, 70, 255);
constexpr ImU32 green = IM_COL32(96, 208, 140, 255);
constexpr ImU32 blue = IM_COL32(110, 180, 255, 255);  // also of marks
constexpr ImU32 shade = IM_COL32(8, 12, 14, 150);

[[nodiscard]] ImU32 colour_of(Level level);

/// Letter height [pixels], as drawn.
[[nodiscard]] float height_of(const ImFont& font);

/// A line of text, or a row of two columns.
struct TextLine {
    std::string text;
    std::string value;  ///< right-aligned; empty: the text uses the whole width and wraps
    ImU32 colour = white;
    bool large = false;
};

struct TextFonts {
    ImFont* small;
    ImFont* large;
};

/// Height [pixels] of a box `width` wide, including its margin.
[[nodiscard]] float text_box_height(const TextFonts& fonts, std::span<const TextLine> lines, float width);

/// Draws lines one below the other on a shaded box with its upper left at `corner`.
void draw_text_box(ImDrawList& list, const TextFonts& fonts, std::span<const TextLine> lines, ImVec2 corner,
                   float width);

}  // namespace eti::hud
