// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/marks.hpp"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <initializer_list>
#include <ranges>

#include "client/hud/text_box.hpp"

namespace eti::hud {
namespace {

using Eigen::Vector2f;

// In thirteenths of the letters' height, as are the following constants.
constexpr float dot_radius = 5.0f, rim = 1.5f, line_width = 2.0f, dash = 10.0f, dash_gap = 4.0f;
constexpr float beside = 10.0f;          // distance of a text from its anchor
const Vector2f text_margin(3.0f, 1.0f);  // padding around a text
constexpr int rows_away = 6;             // of a text from its mark, at most

bool is_dot(const Mark& mark) {
    return mark.from == mark.to;
}

Vector2f size_of(const Mark& mark, const ImFont& font) {
    const ImVec2 size = font.CalcTextSizeA(height_of(font), FLT_MAX, 0.0f, mark.text.c_str());
    return {size.x, size.y};
}

// The last point of a line inside the tile.
std::optional<Vector2f> last_within(const Mark& mark, const Box& tile) {
    constexpr int steps = 64;
    for (int i = steps; i >= 0; --i) {
        const Vector2f point = mark.from + static_cast<float>(i) / steps * (mark.to - mark.from);
        if (Box{point, point}.within(tile)) {
            return point;
        }
        if (is_dot(mark)) {
            break;
        }
    }
    return std::nullopt;
}

ImVec2 of(const Vector2f& point) {
    return {point.x(), point.y()};
}

void draw_stroke(ImDrawList& list, const Mark& mark, float unit) {
    const ImU32 colour = colour_of(mark.level);
    const float length = (mark.to - mark.from).norm();
    const float period = unit * (dash + dash_gap);
    // A line that reaches far beyond the picture has more dashes than can be seen.
    constexpr float most_dashes = 500.0f;
    if (mark.level != Level::bad || length < period || length > most_dashes * period) {
        list.AddLine(of(mark.from), of(mark.to), colour, unit * line_width);
        return;
    }
    const Vector2f along = (mark.to - mark.from) / length;
    for (float at = 0.0f; at < length; at += period) {
        list.AddLine(of(mark.from + at * along), of(mark.from + std::min(at + unit * dash, length) * along),
                     colour, unit * line_width);
    }
}

}  // namespace

void place_labels(Tile& tile, const ImFont& font, std::span<const Box> boxes) {
    const float unit = height_of(font) / 13.0f;
    const Vector2f corner(static_cast<float>(tile.x), static_cast<float>(tile.y));
    const Vector2f extent(static_cast<float>(tile.width), static_cast<float>(tile.height));
    const Vector2f margin = unit * text_margin;
    const Box room{corner, corner + extent};
    std::vector<Box> taken(boxes.begin(), boxes.end());
    for (const Mark& mark : tile.marks) {
        if (is_dot(mark) && !mark.bare) {
            const Vector2f reach = Vector2f::Constant(unit * dot_radius + 1.0f);
            taken.push_back({mark.to - reach, mark.to + reach});
        }
    }
    for (Mark& mark : tile.marks | std::views::reverse) {
        mark.label.reset();
        const auto anchor = last_within(mark, room);
        const auto hides_anchor = [&](const Box& box) { return anchor && Box{*anchor, *anchor}.within(box); };
        if (mark.text.empty() || !anchor || std::ranges::any_of(boxes, hides_anchor)) {
            continue;
        }
        const Vector2f size = size_of(mark, font);
        const auto box_at = [&](const Vector2f& at) { return Box{at - margin, at + size + margin}; };
        const auto is_free = [&](const Box& box) {
            return box.within(room) &&
                   std::ranges::none_of(taken, [&](const Box& one) { return box.meets(one); });
        };
        const float left = anchor->x() - unit * beside - size.x(), right = anchor->x() + unit * beside;
        const float centred = anchor->x() - 0.5f * size.x();
        const float level = anchor->y() - 0.5f * size.y(), row = size.y() + 2.0f * margin.y() + 1.0f;
        std::optional<Vector2f> found;
        for (int step = 0; step <= 2 * rows_away && !found; ++step) {
            const int rows = step % 2 == 0 ? step / 2 : -(step + 1) / 2;  // 0, -1, 1, -2, 2, ...
            for (const float x :
                 {mark.text_left ? left : right, mark.text_left ? right : left, centred,
                  std::clamp(centred, room.low.x() + margin.x(),
                             std::max(room.low.x() + margin.x(), room.high.x() - size.x() - margin.x()))}) {
                const Vector2f at(x, level + static_cast<float>(rows) * row);
                if (!found && is_free(box_at(at))) {
                    found = at;
                }
            }
        }
        if (found) {
            taken.push_back(box_at(*found));
            mark.label = *found - mark.to;
        }
    }
}

void draw_marks(ImDrawList& list, const Tile& tile, const ImFont& font) {
    const float unit = height_of(font) / 13.0f;
    const Vector2f margin = unit * text_margin;
    for (const Mark& mark : tile.marks) {
        if (mark.bare) {
            continue;  // the caller draws the anchor
        }
        if (is_dot(mark)) {
            // A dark rim makes it stand out from bright tissue.
            list.AddCircleFilled(of(mark.from), unit * (dot_radius + rim), shade);
            draw_sign(list, mark.level, of(mark.from), unit * dot_radius);
        } else {
            draw_stroke(list, mark, unit);
        }
    }
    for (const Mark& mark : tile.marks) {
        if (mark.label) {
            // Text is aligned to whole pixels.
            const Vector2f at = (mark.to + *mark.label).array().round();
            list.AddRectFilled(of(at - margin), of(at + size_of(mark, font) + margin), shade, 3.0f * unit);
            list.AddText(&font, height_of(font), of(at), colour_of(mark.level), mark.text.c_str());
        }
    }
}

}  // namespace eti::hud
