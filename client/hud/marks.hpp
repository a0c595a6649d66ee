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

/// A line with its text beside it, or a dot if both ends coincide; pixels from the picture's upper left.
struct Mark {
    Eigen::Vector2f from, to;
    Level level = Level::good;
    std::string text;
    bool text_left = false;  ///< text to the left instead of the right
    bool bare = false;       ///< text only
    /// Offset from `to` to the text's upper left; set by place_labels(), nullopt: not shown.
    std::optional<Eigen::Vector2f> label{};
};

/// A part of the picture with a title in its corner; pixels from the upper left.
struct Tile {
    std::string_view title;
    int x = 0, y = 0, width = 0, height = 0;
    std::vector<Mark> marks{};  ///< clipped to the tile
};

/// Places each mark's text within the tile so that it overlaps no other text or dot. Later marks are placed
/// first and stay nearest to their anchor. Texts of dots outside the tile are hidden; a line's text is
/// placed at its last point inside.
void place_labels(Tile& tile, const ImFont& font);

/// Draws lines and dots, then all texts that have a place.
void draw_marks(ImDrawList& list, const Tile& tile, const ImFont& font);

}  // namespace eti::hud
