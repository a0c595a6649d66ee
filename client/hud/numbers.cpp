// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// Counts of the overlay: in a corner of the first view, or in a strip if the view is small.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/hud/hud.hpp"
#include "client/hud/text_box.hpp"
#include "common/math/units.hpp"

namespace eti::hud {
namespace {

constexpr float counts_width = 176.0f;
constexpr float gum_force_scale_n = 6.0f;  // full length of the bar

void bar(ImDrawList& list, ImVec2 at, float width, float share, ImU32 colour) {
    const float filled = width * std::clamp(share, 0.0f, 1.0f);
    list.AddRectFilled(at, ImVec2(at.x + width, at.y + 8.0f), IM_COL32(60, 68, 72, 220), 2.0f);
    list.AddRectFilled(at, ImVec2(at.x + filled, at.y + 8.0f), colour, 2.0f);
}

bool late(const Readout& readout) {
    return readout.behind_s > 0.5f;
}

std::string clock_text(double seconds) {
    return fmt::format("{:02d}:{:04.1f}", static_cast<int>(seconds) / 60,
                       seconds - 60.0 * (static_cast<int>(seconds) / 60));
}

std::string tube_text(const Readout& readout) {
    if (!readout.airway_measured) {
        return "tube depth unknown";
    }
    const float past_cords_cm = readout.measures.tube_depth_past_glottis / centimetre;
    return past_cords_cm > 0.0f ? fmt::format("tube {:4.1f} cm past cords", past_cords_cm)
                                : std::string("tube before cords");
}

/// A live measure as text; `unknown` for one that a manikin does not measure or an older session file lacks.
std::string measure_text(const Readout& readout, float LiveMeasures::*measure, std::string_view format,
                         std::string_view unknown) {
    const float value = readout.measures.*measure;
    return readout.airway_measured && std::isfinite(value) ? fmt::format(fmt::runtime(format), value)
                                                           : std::string(unknown);
}

std::string server_text(const Readout& readout) {
    return late(readout) ? fmt::format("server {:.0f} %, {:.0f} s behind", 100.0f * readout.server_load,
                                       readout.behind_s)
                         : fmt::format("server {:3.0f} %", 100.0f * readout.server_load);
}

std::string attempt_text(const Readout& readout) {
    return readout.attempt == 0
               ? std::string("no attempt yet")
               : fmt::format("attempt {}{}", readout.attempt, readout.attempt_running ? "" : " ended");
}

}  // namespace

void Hud::draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile, Gap& gap) const {
    const float left = static_cast<float>(tile.x) + 8.0f;
    float y = static_cast<float>(tile.y) + 8.0f;
    constexpr float column = 168.0f, high = 166.0f;
    list.AddRectFilled(ImVec2(left - 4.0f, y - 4.0f), ImVec2(left + column + 4.0f, y + high), shade, 4.0f);
    gap.left = left + column + 4.0f + edge;
    const float below = y + high + 8.0f;
    const std::string clock = clock_text(readout.time_s);
    list.AddText(large_, 26.0f, ImVec2(left, y), white, clock.c_str());
    list.AddText(ImVec2(left, y + 28.0f), readout.attempt_running ? green : grey,
                 attempt_text(readout).c_str());
    y += 46.0f;
    const auto line = [&](const std::string& text, ImU32 colour) {
        list.AddText(small_, 13.0f, ImVec2(left, y), colour, text.c_str());
        y += 15.0f;
    };
    line(measure_text(readout, &LiveMeasures::gum_force_n, "gum force   {:5.1f} N", "gum force       -"),
         white);
    bar(list, ImVec2(left, y), column, readout.measures.gum_force_n / gum_force_scale_n,
        colour_of(level_of(&LiveMeasures::gum_force_n, readout.measures.gum_force_n)));
    y += 13.0f;
    line(measure_text(readout, &LiveMeasures::glottic_opening_percent, "glottis seen {:4.0f} %",
                      "glottis seen    -"),
         white);
    bar(list, ImVec2(left, y), column, readout.measures.glottic_opening_percent / 100.0f, green);
    y += 13.0f;
    line(readout.blade_depth_cm > 0.0f ? fmt::format("blade depth {:5.1f} cm", readout.blade_depth_cm)
                                       : std::string("blade outside"),
         white);
    line(tube_text(readout), white);
    line(measure_text(readout, &LiveMeasures::tube_force_n, "tube force  {:5.2f} N", "tube force      -"),
         white);
    line(server_text(readout), late(readout) ? amber : grey);
    draw_counts(list, readout, below);
}

// The numbers in rows along the upper edge, for small views.
void Hud::draw_strip(ImDrawList& list, const Readout& readout, Gap& gap) const {
    std::vector<std::pair<std::string, ImU32>> words{
        {clock_text(readout.time_s), white},
        {attempt_text(readout), readout.attempt_running ? green : grey},
        {measure_text(readout, &LiveMeasures::gum_force_n, "gum {:.1f} N", "gum -"),
         readout.airway_measured
             ? colour_of(level_of(&LiveMeasures::gum_force_n, readout.measures.gum_force_n))
             : white},
        {measure_text(readout, &LiveMeasures::glottic_opening_percent, "glottis {:.0f} %", "glottis -"),
         white},
        {readout.blade_depth_cm > 0.0f ? fmt::format("blade {:.1f} cm", readout.blade_depth_cm)
                                       : std::string("blade outside"),
         white},
        {measure_text(readout, &LiveMeasures::tube_force_n, tube_text(readout) + ", {:.2f} N",
                      tube_text(readout)),
         white}};
    if (const auto& clock = readout.clock) {
        words.emplace_back(fmt::format("{:.1f}/{:.0f} s", clock->time_s, clock->limit_s),
                           colour_of(clock->level()));
    }
    if (const auto& depth = readout.tube_depth) {
        words.emplace_back(
            fmt::format("tube at the lip {:.1f} cm, by the rule {:.1f}", depth->at_lip_cm, depth->rule_cm),
            colour_of(depth->level()));
    }
    words.emplace_back(server_text(readout), late(readout) ? amber : grey);
    constexpr float between = 14.0f, line = 15.0f, inside = 6.0f;
    std::vector<ImVec2> places;
    float x = inside, y = 3.0f;
    for (const auto& [text, colour] : words) {
        const float wide = ImGui::CalcTextSize(text.c_str()).x;
        if (x > inside && x + wide > width_ - inside) {
            x = inside;
            y += line;
        }
        places.emplace_back(x, y);
        x += wide + between;
    }
    list.AddRectFilled(ImVec2(0.0f, 0.0f), ImVec2(width_, y + line + 2.0f), shade);
    for (std::size_t i = 0; i < words.size(); ++i) {
        list.AddText(places[i], words[i].second, words[i].first.c_str());
    }
    gap.top = y + line + 2.0f + edge;
}

// At the right, as on a patient monitor.
void Hud::draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, Gap& gap) const {
    constexpr float wide = 124.0f, high = 78.0f, label = 12.0f, number = 26.0f;
    const ImVec2 corner(width_ - wide - edge, gap.top);
    gap.right = corner.x - edge;
    list.AddRectFilled(corner, ImVec2(corner.x + wide, corner.y + high), shade, 4.0f);
    float y = corner.y + 6.0f;
    const auto line = [&](const char* name, double value, Level level) {
        const std::string text = fmt::format("{:3.0f}", value);
        list.AddText(small_, 13.0f, ImVec2(corner.x + 8.0f, y + label), grey, name);
        list.AddText(large_, number, ImVec2(corner.x + 74.0f, y), colour_of(level), text.c_str());
        y += number + 8.0f;
    };
    line("SpO2 %", signs.oxygen_saturation_percent,
         level_of(&LiveMeasures::oxygen_saturation_percent, signs.oxygen_saturation_percent));
    line("HR /min", signs.heart_rate_per_min,
         level_of(&LiveMeasures::heart_rate_per_min, signs.heart_rate_per_min));
}

void Hud::draw_counts(ImDrawList& list, const Readout& readout, float below) const {
    std::vector<TextLine> lines;
    if (const auto& clock = readout.clock) {
        lines.push_back({.text = fmt::format("{:.1f}/{:.0f} s", clock->time_s, clock->limit_s),
                         .value = {},
                         .colour = colour_of(clock->level()),
                         .large = true});
    }
    if (const auto& depth = readout.tube_depth) {
        lines.push_back({.text = "tube at the lip",
                         .value = fmt::format("{:.1f} cm", depth->at_lip_cm),
                         .colour = colour_of(depth->level())});
        lines.push_back(
            {.text = "by the rule", .value = fmt::format("{:.1f} cm", depth->rule_cm), .colour = grey});
    }
    if (!lines.empty()) {
        draw_text_box(list, {small_, large_}, lines, ImVec2(edge, below), counts_width);
    }
}

}  // namespace eti::hud
