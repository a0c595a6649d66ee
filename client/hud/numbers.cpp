// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// Numbers of the overlay: in a corner of the first view, or in a strip if the view is small.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "client/hud/hud.hpp"
#include "client/text/catalogue.hpp"
#include "common/math/units.hpp"

namespace eti::hud {
namespace {

using text::translate;
using text::translate_format;

constexpr float gum_force_scale_n = 6.0f;  // full length of the bar

// A bar with ticks at the limits, so that the level can be read from its length alone.
struct NumberBar {
    float share;
    ImU32 colour;
    std::vector<float> ticks;
};

struct NumberRow {
    TextLine line;
    std::optional<NumberBar> bar{};
};

void draw_bar(ImDrawList& list, const TextFonts& fonts, ImVec2 at, float width, const NumberBar& bar) {
    const float high = fonts.px(7.0f), filled = width * std::clamp(bar.share, 0.0f, 1.0f);
    list.AddRectFilled(at, ImVec2(at.x + width, at.y + high), rail, fonts.px(2.0f));
    list.AddRectFilled(at, ImVec2(at.x + filled, at.y + high), bar.colour, fonts.px(2.0f));
    for (const float tick : bar.ticks) {
        const float x = std::round(at.x + tick * width), half = 0.5f * fonts.px(2.0f),
                    beyond = fonts.px(2.0f);
        list.AddRectFilled(ImVec2(x - half - 1.0f, at.y - beyond),
                           ImVec2(x + half + 1.0f, at.y + high + beyond), opaque_shade);
        list.AddRectFilled(ImVec2(x - half, at.y - beyond), ImVec2(x + half, at.y + high + beyond), white);
    }
}

bool late(const Readout& readout) {
    return readout.behind_s > 0.5f;
}

std::string clock_text(double seconds) {
    return fmt::format("{:02d}:{:04.1f}", static_cast<int>(seconds) / 60,
                       seconds - 60.0 * (static_cast<int>(seconds) / 60));
}

std::string label_of(float LiveMeasures::*measure) {
    return std::string(translate(live_measure(measure).short_label));
}

/// A live measure as text; "-" for one that a manikin does not measure or an older session file lacks.
std::string measure_text(const Readout& readout, float LiveMeasures::*measure, std::string_view format) {
    const float value = readout.measures.*measure;
    return readout.airway_measured && std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

Level gum_level(const Readout& readout) {
    return readout.airway_measured ? level_of(&LiveMeasures::gum_force_n, readout.measures.gum_force_n)
                                   : Level::neutral;
}

float tube_past_cords_cm(const Readout& readout) {
    return readout.measures.tube_depth_past_glottis / centimetre;
}

std::string server_load_text(const Readout& readout) {
    return late(readout)
               ? translate_format("{:.0f} %, {:.0f} s behind", 100.0f * readout.server_load, readout.behind_s)
               : fmt::format("{:.0f} %", 100.0f * readout.server_load);
}

std::string attempt_text(const Readout& readout) {
    return readout.attempt == 0      ? std::string(translate("no attempt yet"))
           : readout.attempt_running ? translate_format("attempt {}", readout.attempt)
                                     : translate_format("attempt {} ended", readout.attempt);
}

TextLine row(std::string_view label, std::string value, ImU32 colour = white) {
    return {.text = std::string(label), .value = std::move(value), .colour = colour};
}

TextLine blade_row(const Readout& readout) {
    return readout.blade_depth_cm > 0.0f
               ? row(translate("blade depth"), fmt::format("{:.1f} cm", readout.blade_depth_cm))
               : row(translate("blade outside"), {});
}

TextLine tube_row(const Readout& readout) {
    if (!readout.airway_measured) {
        return row(translate("tube depth unknown"), {});
    }
    const float past = tube_past_cords_cm(readout);
    return past > 0.0f ? row(label_of(&LiveMeasures::tube_depth_past_glottis), fmt::format("{:.1f} cm", past))
                       : row(translate("tube before cords"), {});
}

std::vector<NumberRow> number_rows(const Readout& readout) {
    const LiveMeasureField& gum = live_measure(&LiveMeasures::gum_force_n);
    TextLine gum_row = row(label_of(&LiveMeasures::gum_force_n),
                           measure_text(readout, &LiveMeasures::gum_force_n, "{:.1f} N"));
    gum_row.sign = gum_level(readout);
    std::vector<NumberRow> rows{
        {{.text = clock_text(readout.time_s), .value = {}, .large = true}},
        {{.text = attempt_text(readout), .value = {}, .colour = readout.attempt_running ? green : grey}},
        {gum_row, NumberBar{readout.measures.gum_force_n / gum_force_scale_n,
                            colour_of(gum_level(readout)),
                            {gum.warning / gum_force_scale_n, gum.bad / gum_force_scale_n}}},
        {row(label_of(&LiveMeasures::glottic_opening_percent),
             measure_text(readout, &LiveMeasures::glottic_opening_percent, "{:.0f} %")),
         NumberBar{readout.measures.glottic_opening_percent / 100.0f, green, {}}},
        {blade_row(readout)},
        {tube_row(readout)},
        {row(label_of(&LiveMeasures::tube_force_n),
             measure_text(readout, &LiveMeasures::tube_force_n, "{:.2f} N"))},
        {row(translate("server"), server_load_text(readout), late(readout) ? amber : grey)}};
    // What the session's aids add.
    if (const auto& clock = readout.clock) {
        rows.push_back({{.text = fmt::format("{:.1f}/{:.0f} s", clock->time_s, clock->limit_s),
                         .value = {},
                         .colour = colour_of(clock->level()),
                         .large = true,
                         .sign = clock->level()}});
    }
    if (const auto& depth = readout.tube_depth) {
        rows.push_back({row(translate("tube at the lip"), fmt::format("{:.1f} cm", depth->at_lip_cm),
                            colour_of(depth->level()))});
        rows.back().line.sign = depth->level();
        rows.push_back({row(translate("by the rule"), fmt::format("{:.1f} cm", depth->rule_cm), grey)});
    }
    return rows;
}

// Wide enough for every text that may stand in the rows, so that the box keeps its width.
float numbers_width(const TextFonts& fonts, std::span<const NumberRow> rows) {
    std::vector<TextLine> lines{row(label_of(&LiveMeasures::gum_force_n), "88.8 N"),
                                row(label_of(&LiveMeasures::glottic_opening_percent), "100 %"),
                                row(label_of(&LiveMeasures::tube_depth_past_glottis), "88.8 cm"),
                                row(label_of(&LiveMeasures::tube_force_n), "8.88 N"),
                                row(translate("blade depth"), "88.8 cm")};
    lines.front().sign = Level::bad;
    for (const std::string_view alone :
         {"blade outside", "tube before cords", "tube depth unknown", "no attempt yet"}) {
        lines.push_back(row(translate(alone), {}));
    }
    for (const NumberRow& one : rows) {
        lines.push_back(one.line);
    }
    return text_box_width(fonts, lines);
}

}  // namespace

void Hud::draw_numbers(ImDrawList& list, const Readout& readout, const Tile& tile, Gap& gap) {
    const std::vector<NumberRow> rows = number_rows(readout);
    const float margin = fonts_.px(9.0f), bar_room = fonts_.px(13.0f), between = fonts_.px(2.0f);
    const float wide = numbers_width(fonts_, rows), inner = wide - 2.0f * margin;
    float high = 2.0f * margin;
    for (const NumberRow& one : rows) {
        high += draw_text_line(nullptr, fonts_, one.line, {}, inner) + between + (one.bar ? bar_room : 0.0f);
    }
    const ImVec2 corner(static_cast<float>(tile.x) + edge(), static_cast<float>(tile.y) + edge());
    add_backing(list, corner, ImVec2(corner.x + wide, corner.y + high));
    float y = corner.y + margin;
    for (const NumberRow& one : rows) {
        y += draw_text_line(&list, fonts_, one.line, ImVec2(corner.x + margin, y), inner) + between;
        if (one.bar) {
            draw_bar(list, fonts_, ImVec2(corner.x + margin, y + fonts_.px(2.0f)), inner, *one.bar);
            y += bar_room;
        }
    }
    gap.left = corner.x + wide + edge();
    numbers_bottom_ = corner.y + high;
}

// The numbers in rows along the upper edge, for small views.
void Hud::draw_strip(ImDrawList& list, const Readout& readout, Gap& gap) {
    const auto words = [](std::string said, ImU32 colour = white) {
        return TextLine{.text = std::move(said), .value = {}, .colour = colour};
    };
    const auto with_level = [](std::string said, Level level) {
        return TextLine{.text = std::move(said), .value = {}, .colour = colour_of(level), .sign = level};
    };
    const float past = tube_past_cords_cm(readout);
    const std::string tube = !readout.airway_measured ? std::string(translate("tube depth unknown"))
                             : past > 0.0f            ? translate_format("tube {:.1f} cm past cords", past)
                                                      : std::string(translate("tube before cords"));
    const std::string force = measure_text(readout, &LiveMeasures::tube_force_n, "{:.2f} N");
    std::vector<TextLine> lines{
        words(clock_text(readout.time_s)),
        words(attempt_text(readout), readout.attempt_running ? green : grey),
        with_level(translate_format("gum {}", measure_text(readout, &LiveMeasures::gum_force_n, "{:.1f} N")),
                   gum_level(readout)),
        words(translate_format("glottis {}",
                               measure_text(readout, &LiveMeasures::glottic_opening_percent, "{:.0f} %"))),
        words(readout.blade_depth_cm > 0.0f ? translate_format("blade {:.1f} cm", readout.blade_depth_cm)
                                            : std::string(translate("blade outside"))),
        words(force == "-" ? tube : tube + ", " + force)};
    if (const auto& clock = readout.clock) {
        lines.push_back(
            with_level(fmt::format("{:.1f}/{:.0f} s", clock->time_s, clock->limit_s), clock->level()));
    }
    if (const auto& depth = readout.tube_depth) {
        lines.push_back(with_level(translate_format("tube at the lip {:.1f} cm, by the rule {:.1f}",
                                                    depth->at_lip_cm, depth->rule_cm),
                                   depth->level()));
    }
    lines.push_back(words(std::string(translate("server")) + " " + server_load_text(readout),
                          late(readout) ? amber : grey));
    const float margin = fonts_.px(4.0f), room = width_ - 2.0f * margin;
    const float high = flow_text(nullptr, fonts_, lines, {}, room) + 2.0f * margin;
    list.AddRectFilled(ImVec2(0.0f, 0.0f), ImVec2(width_, high), shade);
    boxes_.push_back({{0.0f, 0.0f}, {width_, high}});
    flow_text(&list, fonts_, lines, ImVec2(margin, margin), room);
    gap.top = high + edge();
    numbers_bottom_ = high;
}

// At the right, as on a patient monitor.
void Hud::draw_vital_signs(ImDrawList& list, const Readout::VitalSigns& signs, Gap& gap) {
    const float margin = fonts_.px(7.0f), number = height_of(*fonts_.large), small = height_of(*fonts_.small);
    struct Sign {
        std::string_view name;
        double value;
        Level level;
    };
    const std::array rows{
        Sign{translate("SpO2 %"), signs.oxygen_saturation_percent,
             level_of(&LiveMeasures::oxygen_saturation_percent, signs.oxygen_saturation_percent)},
        Sign{translate("HR /min"), signs.heart_rate_per_min,
             level_of(&LiveMeasures::heart_rate_per_min, signs.heart_rate_per_min)}};
    float names = 0.0f;
    for (const Sign& one : rows) {
        names = std::max(names, text_extent(*fonts_.small, std::string(one.name), 1e6f).x);
    }
    const float digits = text_extent(*fonts_.large, "888", 1e6f).x, shape = sign_width(fonts_, false);
    const float wide = names + shape + digits + 2.0f * margin + fonts_.px(12.0f);
    const ImVec2 corner(width_ - wide - edge(), gap.top);
    const float high = 2.0f * (number + fonts_.px(2.0f)) + 2.0f * margin;
    add_backing(list, corner, ImVec2(corner.x + wide, corner.y + high));
    gap.right = corner.x - edge();
    float y = corner.y + margin;
    for (const Sign& one : rows) {
        const std::string value = fmt::format("{:.0f}", one.value);
        const float left = corner.x + wide - margin - text_extent(*fonts_.large, value, 1e6f).x;
        list.AddText(fonts_.small, small, ImVec2(corner.x + margin, std::round(y + 0.62f * (number - small))),
                     grey, one.name.data(), one.name.data() + one.name.size());
        draw_sign(list, one.level,
                  ImVec2(corner.x + wide - margin - digits - shape, std::round(y + 0.52f * number)),
                  0.3f * small);
        list.AddText(fonts_.large, number, ImVec2(std::floor(left), y), colour_of(one.level), value.c_str());
        y += number + fonts_.px(2.0f);
    }
}

}  // namespace eti::hud
