// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "client/hud/marks.hpp"
#include "client/hud/readout.hpp"
#include "client/hud/text_box.hpp"

struct ImDrawList;

namespace eti::hud {

/// Height of the small letters [pixels] in a picture: a fortieth of its shorter side, at least 13.
[[nodiscard]] int letter_height(int width, int height, float text_scale = 1.0f);

/// Draws the readout over a finished picture. Only one instance at a time, for the OpenGL context current
/// at construction (Dear ImGui keeps one global state). Text lies on boxes opaque enough for a contrast of
/// 4.5:1 over any picture.
class Hud {
  public:
    Hud();
    ~Hud();
    Hud(const Hud&) = delete;
    Hud& operator=(const Hud&) = delete;

    /// Letters larger or smaller than usual, by this factor.
    static constexpr float min_text_scale = 0.5f, max_text_scale = 3.0f;
    void set_text_scale(float scale) { text_scale_ = scale; }

    /// Draws into the bound framebuffer of `width` x `height` pixels.
    void draw(const Readout& readout, std::span<const Tile> tiles, int width, int height);
    /// Draws marks only, over a stereo pair side by side, left first: both eyes get the same marks, with
    /// texts at the same offset, so that each text appears at the depth of its mark.
    void draw_eyes(std::span<Tile, 2> eyes, int width, int height);

    /// Boxes of the last draw(): numbers, notices, verdict and so on.
    [[nodiscard]] std::span<const Box> boxes() const { return boxes_; }
    /// The box of the last draw()'s verdict; empty if there was none.
    [[nodiscard]] const std::optional<Box>& verdict_box() const { return verdict_box_; }

  private:
    /// Free space between the boxes in the corners; [pixels] from the upper left.
    struct Gap {
        float left, right, top, bottom;
    };
    void begin(int width, int height, int letters);
    static void end();
    /// Margin at the picture's edge [pixels].
    [[nodiscard]] float edge() const { return fonts_.px(4.0f); }

    /// A text box that counts as one of boxes().
    void add_box(ImDrawList& list, std::span<const TextLine> lines, ImVec2 corner, float width);
    void add_backing(ImDrawList& list, ImVec2 low, ImVec2 high);

    void draw_tile(ImDrawList& list, const Tile& tile, bool framed) const;
    void draw_title(ImDrawList& list, const Tile& tile);
    void draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile, Gap& gap);
    void draw_strip(ImDrawList& list, const Readout& readout, Gap& gap);
    void draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, Gap& gap);
    void draw_notice(ImDrawList& list, const Readout& readout, Gap& gap);
    void draw_alarms(ImDrawList& list, std::span<const std::string> alarms, const Tile& first, Gap& gap);
    void draw_verdict(ImDrawList& list, const Readout& readout, Gap& gap);
    [[nodiscard]] static TextLine notice_line(const Readout& readout);
    void draw_guidance(ImDrawList& list, const Readout& readout, const Gap& gap);
    void draw_top(ImDrawList& list, const Readout& readout, const Gap& gap);
    void draw_help(ImDrawList& list, const Readout& readout, const Gap& gap);
    [[nodiscard]] float beside_numbers(float wide, const Gap& gap) const;

    std::map<int, TextFonts> fonts_by_height_;
    TextFonts fonts_{nullptr, nullptr};
    float text_scale_ = 1.0f;
    float width_ = 0.0f, height_ = 0.0f;  // of the picture [pixels]
    float numbers_bottom_ = 0.0f;         // lower edge of numbers and counts [pixels]
    std::vector<Box> boxes_;
    std::optional<Box> verdict_box_;
};

}  // namespace eti::hud
