// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/hud/readout.hpp"

struct ImDrawList;
struct ImFont;

namespace eti::hud {

/// A rectangle; pixels from the picture's upper left.
struct Box {
    Eigen::Vector2f low, high;

    [[nodiscard]] bool meets(const Box& other) const {
        return (low.array() < other.high.array()).all() && (other.low.array() < high.array()).all();
    }
    [[nodiscard]] bool within(const Box& other) const {
        return (low.array() >= other.low.array()).all() && (high.array() <= other.high.array()).all();
    }
};

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
    std::vector<Mark> marks{};   ///< clipped to the tile
    float magnification = 1.0f;  ///< of a loupe, shown in the title
};

/// Places each mark's text within the tile so that it overlaps no other text, dot or one of `boxes`. Later
/// marks are placed first and stay nearest to their anchor. Texts of dots outside the tile or beneath a box
/// are hidden, as are texts for which there is no room; a line's text is placed at its last point inside.
void place_labels(Tile& tile, const ImFont& font, std::span<const Box> boxes = {});

/// Draws lines and dots, then all texts that have a place. A level is a shape as well as a colour: dots as in
/// draw_sign(), lines solid or, if bad, dashed.
void draw_marks(ImDrawList& list, const Tile& tile, const ImFont& font);

}  // namespace eti::hud
