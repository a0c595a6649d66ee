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

/// Draws the readout over a finished picture. One at a time, for the OpenGL context current when it
/// was made (Dear ImGui keeps one global state).
class Hud {
  public:
    Hud();
    ~Hud();
    Hud(const Hud&) = delete;
    Hud& operator=(const Hud&) = delete;

    /// Into the bound framebuffer of `width` x `height` pixels. Letters are twice as large from 900 pixels on
    /// the shorter side, and four times from 1800.
    void draw(const Readout& readout, std::span<const Tile> tiles, int width, int height);
    /// Marks alone, over the pictures of two eyes side by side, left first: the same marks in both, whose
    /// texts stand at the same place beside them, so that each lies as far away as what it names.
    void draw_eyes(std::span<Tile, 2> eyes, int width, int height);

  private:
    /// Between what is drawn and the picture's edge [pixels].
    static constexpr float edge = 4.0f;
    /// What is left between what stands in the corners; [pixels] from the upper left.
    struct Gap {
        float left, right, top, bottom;
    };
    void begin(int width, int height, int scale);
    static void end();

    void draw_tile(ImDrawList& list, const Tile& tile, bool framed) const;
    void draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile, Gap& gap) const;
    void draw_strip(ImDrawList& list, const Readout& readout, Gap& gap) const;
    void draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, Gap& gap) const;
    /// What the session's aids count; below the numbers.
    void draw_counts(ImDrawList& list, const Readout& readout, float below) const;
    void draw_notice(ImDrawList& list, const Readout& readout, Gap& gap) const;
    void draw_alarms(ImDrawList& list, std::span<const std::string> alarms, const Tile& first,
                     Gap& gap) const;
    void draw_verdict(ImDrawList& list, const Verdict& verdict, const Gap& gap) const;
    void draw_keys(ImDrawList& list, const Readout& readout, const Gap& gap) const;
    [[nodiscard]] float beside_numbers(float wide, const Gap& gap) const;

    /// By the scale that letters are made for.
    std::map<int, std::pair<ImFont*, ImFont*>> fonts_;
    ImFont* small_ = nullptr;
    ImFont* large_ = nullptr;
    float width_ = 0.0f, height_ = 0.0f;  // of the picture, in pixels of small letters
};

}  // namespace eti::hud
