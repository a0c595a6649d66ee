// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>

#include "client/hud/marks.hpp"
#include "client/hud/readout.hpp"

struct ImDrawList;
struct ImFont;

namespace eti::hud {

/// Draws the readout over a finished picture. Only one instance at a time, for the OpenGL context current
/// at construction (Dear ImGui keeps one global state).
class Hud {
  public:
    Hud();
    ~Hud();
    Hud(const Hud&) = delete;
    Hud& operator=(const Hud&) = delete;

    /// Draws into the bound framebuffer of `width` x `height` pixels. Letters double in size from 900
    /// pixels on the shorter side, and quadruple from 1800.
    void draw(const Readout& readout, std::span<const Tile> tiles, int width, int height);
    /// Draws marks only, over a stereo pair side by side, left first: both eyes get the same marks, with
    /// texts at the same offset, so that each text appears at the depth of its mark.
    void draw_eyes(std::span<Tile, 2> eyes, int width, int height);

  private:
    /// Margin at the picture's edge [pixels].
    static constexpr float edge = 4.0f;
    /// Free space between the boxes in the corners; [pixels] from the upper left.
    struct Gap {
        float left, right, top, bottom;
    };
    void begin(int width, int height, int scale);
    static void end();

    void draw_tile(ImDrawList& list, const Tile& tile, bool framed) const;
    void draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile, Gap& gap) const;
    void draw_strip(ImDrawList& list, const Readout& readout, Gap& gap) const;
    void draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, Gap& gap) const;
    /// Counts shown by the session's aids; below the numbers.
    void draw_counts(ImDrawList& list, const Readout& readout, float below) const;
    void draw_notice(ImDrawList& list, const Readout& readout, Gap& gap) const;
    void draw_alarms(ImDrawList& list, std::span<const std::string> alarms, const Tile& first,
                     Gap& gap) const;
    void draw_verdict(ImDrawList& list, const Verdict& verdict, const Gap& gap) const;
    void draw_keys(ImDrawList& list, const Readout& readout, const Gap& gap) const;
    [[nodiscard]] float beside_numbers(float wide, const Gap& gap) const;

    /// By font scale.
    std::map<int, std::pair<ImFont*, ImFont*>> fonts_;
    ImFont* small_ = nullptr;
    ImFont* large_ = nullptr;
    float width_ = 0.0f, height_ = 0.0f;  // of the picture, in pixels of unscaled letters
};

}  // namespace eti::hud
