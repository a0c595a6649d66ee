// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/hud/readout.hpp"

struct ImDrawList;
struct ImFont;

namespace eti::hud {

/// A line, or where both ends are one a dot, with its text beside it; pixels from the picture's upper left.
struct Mark {
    Eigen::Vector2f from, to;
    Level level = Level::good;
    std::string text;
    bool text_left = false;  ///< rather than to the right
    bool bare = false;       ///< the text alone
    /// From `to` to the text's upper left; nothing, before place_labels(): it is not shown.
    std::optional<Eigen::Vector2f> label{};
};

/// A part of the picture with a title in its corner; pixels from the upper left.
struct Tile {
    std::string_view title;
    int x = 0, y = 0, width = 0, height = 0;
    std::vector<Mark> marks{};  ///< what lies outside is cut off
};

/// Finds a place for each mark's text, within the tile and beside all other texts and dots: those of later
/// marks first, which stay nearest to what they name. Texts of dots outside the tile are not shown; that of a
/// line stands at its last point within.
void place_labels(Tile& tile, const ImFont& font);

/// Draws lines and dots, and above them all texts that have a place.
void draw_marks(ImDrawList& list, const Tile& tile, const ImFont& font);

}  // namespace eti::hud
