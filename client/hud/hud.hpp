// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <span>
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
};

/// A part of the picture with a title in its corner; pixels from the upper left.
struct Tile {
    std::string_view title;
    int x = 0, y = 0, width = 0, height = 0;
    std::vector<Mark> marks{};  ///< what lies outside is cut off
};

/// Draws the readout over a finished picture. One at a time, for the OpenGL context current when it
/// was made (Dear ImGui keeps one global state).
class Hud {
  public:
    Hud();
    ~Hud();
    Hud(const Hud&) = delete;
    Hud& operator=(const Hud&) = delete;

    /// Into the bound framebuffer of `width` x `height` pixels.
    void draw(const Readout& readout, std::span<const Tile> tiles, int width, int height);

  private:
    void draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile) const;
    void draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, int width) const;
    /// What the session's aids count; below the numbers.
    void draw_counts(ImDrawList& list, const Readout& readout) const;
    void draw_alarms(ImDrawList& list, std::span<const std::string> alarms, int width, int height) const;
    void draw_verdict(ImDrawList& list, const Verdict& verdict, int width, float bottom) const;
    void draw_keys(ImDrawList& list, const Readout& readout, int width, int height) const;
    void draw_notice(ImDrawList& list, const Readout& readout, int width, int height) const;

    ImFont* small_ = nullptr;
    ImFont* large_ = nullptr;
};

}  // namespace eti::hud
