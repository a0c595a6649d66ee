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

constexpr float dot_radius = 5.0f, rim = 1.5f;          // [pixels], as are the following constants
constexpr float beside = 10.0f;                         // distance of a text from its anchor
const Vector2f text_margin(3.0f, 1.0f);                 // padding around a text
constexpr ImU32 text_shade = IM_COL32(8, 12, 14, 205);  // makes red text readable on a tongue

struct Box {
    Vector2f low, high;
    [[nodiscard]] bool meets(const Box& other) const {
        return (low.array() < other.high.array()).all() && (other.low.array() < high.array()).all();
    }
    [[nodiscard]] bool within(const Box& other) const {
        return (low.array() >= other.low.array()).all() && (high.array() <= other.high.array()).all();
    }
};

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

}  // namespace

void place_labels(Tile& tile, const ImFont& font) {
    const Vector2f corner(static_cast<float>(tile.x), static_cast<float>(tile.y));
    const Vector2f extent(static_cast<float>(tile.width), static_cast<float>(tile.height));
    const Box room{corner, corner + extent};
    std::vector<Box> taken;
    for (const Mark& mark : tile.marks) {
        if (is_dot(mark) && !mark.bare) {
            const Vector2f reach = Vector2f::Constant(dot_radius + 1.0f);
            taken.push_back({mark.to - reach, mark.to + reach});
        }
    }
    for (Mark& mark : tile.marks | std::views::reverse) {
        mark.label.reset();
        const auto anchor = last_within(mark, room);
        if (mark.text.empty() || !anchor) {
            continue;
        }
        const Vector2f size = size_of(mark, font);
        const auto box_at = [&](const Vector2f& at) {
            return Box{at - text_margin, at + size + text_margin};
        };
        const float left = anchor->x() - beside - size.x(), right = anchor->x() + beside;
        const float level = anchor->y() - 0.5f * size.y(), row = size.y() + 2.0f * text_margin.y() + 1.0f;
        std::optional<Vector2f> found;
        for (const int rows : {0, -1, 1, -2, 2, -3, 3, -4, 4}) {
            for (const float x : {mark.text_left ? left : right, mark.text_left ? right : left}) {
                const Vector2f at(x, level + static_cast<float>(rows) * row);
                const Box box = box_at(at);
                if (!found && box.within(room) &&
                    std::ranges::none_of(taken, [&](const Box& one) { return box.meets(one); })) {
                    found = at;
                }
            }
        }
        if (!found) {  // crowded: at least inside the tile
            const Vector2f most = (room.high - size - text_margin).cwiseMax(room.low + text_margin);
            found = Vector2f(mark.text_left ? left : right, level)
                        .cwiseMin(most)
                        .cwiseMax(room.low + text_margin);
        }
        taken.push_back(box_at(*found));
        mark.label = *found - mark.to;
    }
}

void draw_marks(ImDrawList& list, const Tile& tile, const ImFont& font) {
    for (const Mark& mark : tile.marks) {
        if (mark.bare) {
            continue;  // the caller draws the anchor
        }
        if (is_dot(mark)) {
            list.AddCircleFilled(of(mark.from), dot_radius, colour_of(mark.level));
            list.AddCircle(of(mark.from), (dot_radius + 1.0f), IM_COL32(8, 12, 14, 255), 0, rim);
        } else {
            list.AddLine(of(mark.from), of(mark.to), colour_of(mark.level), 2.0f);
        }
    }
    for (const Mark& mark : tile.marks) {
        if (mark.label) {
            // Text is aligned to whole pixels.
            const Vector2f at = (mark.to + *mark.label).array().round();
            list.AddRectFilled(of(at - text_margin), of(at + size_of(mark, font) + text_margin), text_shade,
                               3.0f);
            list.AddText(&font, height_of(font), of(at), colour_of(mark.level), mark.text.c_str());
        }
    }
}

}  // namespace eti::hud
