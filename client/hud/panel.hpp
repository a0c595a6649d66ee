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
constexpr ImU32 blue = IM_COL32(110, 180, 255, 255);  // of marks, too
constexpr ImU32 shade = IM_COL32(8, 12, 14, 150);

[[nodiscard]] ImU32 colour_of(Level level);

/// Of its letters [pixels], as they are drawn.
[[nodiscard]] float height_of(const ImFont& font);

/// A line of a panel, or a row of two columns.
struct PanelLine {
    std::string text;
    std::string value;  ///< at the right edge; empty: the text has the whole width and is wrapped
    ImU32 colour = white;
    bool large = false;
};

struct PanelFonts {
    ImFont* small;
    ImFont* large;
};

/// Height [pixels] of a panel `width` wide, its margin included.
[[nodiscard]] float panel_height(const PanelFonts& fonts, std::span<const PanelLine> lines, float width);

/// Lines one below the other on a shade whose upper left corner is `corner`.
void draw_panel(ImDrawList& list, const PanelFonts& fonts, std::span<const PanelLine> lines, ImVec2 corner,
                float width);

}  // namespace eti::hud
