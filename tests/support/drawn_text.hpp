// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <imgui.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/render/image.hpp"

namespace eti::test {

/// A line of text in a picture [pixels from the upper left].
struct DrawnLine {
    std::string text;
    Eigen::AlignedBox2f box;   ///< of its letters
    Eigen::AlignedBox2f clip;  ///< area outside which nothing of it is drawn
    ImU32 colour = 0;
};

/// Reads back the text of the last frame of the current Dear ImGui context, in drawing order: a letter is a
/// quad whose texture coordinates are those of a glyph. Letters of one font, colour and baseline form a line
/// if whole spaces separate them.
[[nodiscard]] inline std::vector<DrawnLine> drawn_lines() {
    std::map<std::pair<float, float>, std::pair<const ImFont*, const ImFontGlyph*>> glyphs;
    for (const ImFont* font : ImGui::GetIO().Fonts->Fonts) {
        for (const ImFontGlyph& glyph : font->Glyphs) {
            if (glyph.Visible) {
                glyphs[{glyph.U0, glyph.V0}] = {font, &glyph};
            }
        }
    }
    const ImDrawData& data = *ImGui::GetDrawData();
    const auto pixel = [&](float x, float y) {
        return Eigen::Vector2f((x - data.DisplayPos.x) * data.FramebufferScale.x,
                               (y - data.DisplayPos.y) * data.FramebufferScale.y);
    };
    std::vector<DrawnLine> lines;
    const ImFont* last_font = nullptr;
    float top = 0.0f, pen = 0.0f;
    for (int l = 0; l < data.CmdListsCount; ++l) {
        const ImDrawList& list = *data.CmdLists[l];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            const ImDrawIdx* const index = list.IdxBuffer.Data + command.IdxOffset;
            const auto corner = [&](unsigned i) -> const ImDrawVert& {
                return list.VtxBuffer[static_cast<int>(command.VtxOffset + index[i])];
            };
            for (unsigned i = 0; i + 6 <= command.ElemCount; i += 3) {
                const ImDrawVert &low = corner(i), &high = corner(i + 2);
                const auto found = glyphs.find({low.uv.x, low.uv.y});
                if (found == glyphs.end() || high.uv.x != found->second.second->U1 ||
                    high.uv.y != found->second.second->V1) {
                    continue;
                }
                const auto& [font, glyph] = found->second;
                const float scale = (high.pos.y - low.pos.y) / (glyph->Y1 - glyph->Y0);
                const float begin = low.pos.x - scale * glyph->X0, above = low.pos.y - scale * glyph->Y0;
                const float spaces = (begin - pen) / (scale * font->GetCharAdvance(' '));
                const bool continues = font == last_font && low.col == lines.back().colour &&
                                       std::abs(above - top) < 0.5f && spaces > -0.1f && spaces < 12.0f &&
                                       std::abs(spaces - std::round(spaces)) < 0.1f;
                if (!continues) {
                    const ImVec4& clip = command.ClipRect;
                    lines.push_back({{}, {}, {pixel(clip.x, clip.y), pixel(clip.z, clip.w)}, low.col});
                } else {
                    lines.back().text.append(static_cast<std::size_t>(std::lround(spaces)), ' ');
                }
                // Beyond ASCII the panel has arrows and dashes: any letter stands for them.
                lines.back().text += glyph->Codepoint < 0x80 ? static_cast<char>(glyph->Codepoint) : '~';
                lines.back().box.extend(pixel(low.pos.x, low.pos.y)).extend(pixel(high.pos.x, high.pos.y));
                last_font = font;
                top = above;
                pen = begin + scale * glyph->AdvanceX;
                i += 3;
            }
        }
    }
    return lines;
}

/// All lines one after the other, with single spaces: a sentence that was wrapped is whole again.
[[nodiscard]] inline std::string sentence(const std::vector<DrawnLine>& lines) {
    std::string all;
    for (const DrawnLine& line : lines) {
        all += line.text + ' ';
    }
    const auto twice = [](char a, char b) { return a == ' ' && b == ' '; };
    all.erase(std::unique(all.begin(), all.end(), twice), all.end());
    return all;
}

/// The first two lines whose letters cover each other; empty if none do.
[[nodiscard]] inline std::string overlapping(const std::vector<DrawnLine>& lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Eigen::AlignedBox2f both = lines[i]
                                                 .box.intersection(lines[i].clip)
                                                 .intersection(lines[j].box)
                                                 .intersection(lines[j].clip);
            // Antialiasing widens a letter by up to half a pixel on each side.
            if (!both.isEmpty() && (both.sizes().array() > 1.0f).all()) {
                return "'" + lines[j].text + "' and '" + lines[i].text + "'";
            }
        }
    }
    return {};
}

/// Contrast of a line against its background by WCAG 2.1: (L1 + 0.05) / (L2 + 0.05) for relative luminances
/// L1 >= L2 of the background, the median of the box with two pixels around it, and of the pixel farthest
/// from it.
[[nodiscard]] inline double contrast(const DrawnLine& line, const render::Image& image) {
    const auto linear = [](std::uint8_t value) {
        const double v = value / 255.0;
        return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    // A dash would fill its box.
    const Eigen::Vector2f around = Eigen::Vector2f::Constant(2.0f);
    const Eigen::AlignedBox2f seen =
        Eigen::AlignedBox2f(line.box.min() - around, line.box.max() + around).intersection(line.clip);
    std::vector<double> luminance;
    for (int y = std::max(0, static_cast<int>(seen.min().y()));
         y < std::min(image.height, static_cast<int>(seen.max().y())); ++y) {
        for (int x = std::max(0, static_cast<int>(seen.min().x()));
             x < std::min(image.width, static_cast<int>(seen.max().x())); ++x) {
            const std::uint8_t* const p = image.pixel(x, y);
            luminance.push_back(0.2126 * linear(p[0]) + 0.7152 * linear(p[1]) + 0.0722 * linear(p[2]));
        }
    }
    if (luminance.empty()) {
        return 0.0;
    }
    std::ranges::sort(luminance);
    const double middle = luminance[luminance.size() / 2];
    return std::max((luminance.back() + 0.05) / (middle + 0.05),
                    (middle + 0.05) / (luminance.front() + 0.05));
}

}  // namespace eti::test
