// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/numerals.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/math/units.hpp"

namespace eti::render {
namespace {

using Point2 = Eigen::Vector2f;
using Stroke = std::vector<Point2>;

constexpr float numeral_width = 0.56f;  // in heights of a numeral

// Part of an ellipse, from one angle to another [deg], counter-clockwise from the right.
Stroke arc(const Point2& centre, const Point2& radii, float from, float to) {
    constexpr int pieces = 24;
    Stroke points;
    for (int k = 0; k <= pieces; ++k) {
        const float angle = degree * (from + (to - from) * static_cast<float>(k) / pieces);
        points.emplace_back(centre + radii.cwiseProduct(Point2(std::cos(angle), std::sin(angle))));
    }
    return points;
}

Stroke then(Stroke first, const Stroke& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

std::vector<Stroke> six() {
    return {arc({0.28f, 0.31f}, {0.28f, 0.31f}, 0, 360), arc({0.52f, 0.31f}, {0.52f, 0.68f}, 180, 95)};
}

// Centre lines, the lower left corner at the origin.
std::vector<Stroke> strokes_of(char glyph) {
    switch (glyph) {
        case '0':
            return {arc({0.28f, 0.5f}, {0.28f, 0.5f}, 0, 360)};
        case '1':
            return {{{0.08f, 0.78f}, {0.32f, 1.0f}, {0.32f, 0.0f}}};
        case '2':
            return {then(arc({0.28f, 0.72f}, {0.27f, 0.28f}, 160, -35), {{0.0f, 0.0f}, {0.56f, 0.0f}})};
        case '3':
            return {arc({0.27f, 0.75f}, {0.25f, 0.25f}, 150, -90),
                    arc({0.27f, 0.25f}, {0.28f, 0.25f}, 90, -150)};
        case '4':
            return {{{0.42f, 0.0f}, {0.42f, 1.0f}, {0.0f, 0.28f}, {0.56f, 0.28f}}};
        case '5':
            return {then({{0.52f, 1.0f}, {0.1f, 1.0f}, {0.06f, 0.53f}},
                         arc({0.27f, 0.32f}, {0.28f, 0.32f}, 135, -150))};
        case '6':
            return six();
        case '7':
            return {{{0.0f, 1.0f}, {0.56f, 1.0f}, {0.2f, 0.0f}}};
        case '8':
            return {arc({0.28f, 0.75f}, {0.24f, 0.25f}, 0, 360), arc({0.28f, 0.26f}, {0.28f, 0.26f}, 0, 360)};
        case '9': {
            std::vector<Stroke> turned = six();
            for (Stroke& stroke : turned) {
                for (Point2& p : stroke) {
                    p = Point2(numeral_width, 1.0f) - p;
                }
            }
            return turned;
        }
        default:
            return {{{0.28f, 0.02f}, {0.28f, 0.03f}}};
    }
}

float distance_to(const std::vector<Stroke>& strokes, const Point2& p) {
    float nearest = std::numeric_limits<float>::max();
    for (const Stroke& stroke : strokes) {
        for (std::size_t k = 1; k < stroke.size(); ++k) {
            const Point2 way = stroke[k] - stroke[k - 1], from = p - stroke[k - 1];
            const float t = std::clamp(from.dot(way) / way.squaredNorm(), 0.0f, 1.0f);
            nearest = std::min(nearest, (from - t * way).norm());
        }
    }
    return nearest;
}

NumeralAtlas draw_atlas() {
    NumeralAtlas atlas;
    const auto count = static_cast<int>(NumeralAtlas::glyphs.size());
    atlas.width = count * NumeralAtlas::cell_width;
    atlas.height = NumeralAtlas::cell_height;
    atlas.texels.resize(static_cast<std::size_t>(atlas.width * atlas.height));
    constexpr float texel = NumeralAtlas::cell_span / NumeralAtlas::cell_height;
    for (int glyph = 0; glyph < count; ++glyph) {
        const auto strokes = strokes_of(NumeralAtlas::glyphs[static_cast<std::size_t>(glyph)]);
        for (int y = 0; y < NumeralAtlas::cell_height; ++y) {
            for (int x = 0; x < NumeralAtlas::cell_width; ++x) {
                const Point2 p((static_cast<float>(x) + 0.5f) * texel - NumeralAtlas::margin_left,
                               (static_cast<float>(y) + 0.5f) * texel - NumeralAtlas::margin_below);
                const float within = (NumeralAtlas::stroke - distance_to(strokes, p)) / NumeralAtlas::spread;
                atlas.texels[static_cast<std::size_t>(y * atlas.width + glyph * NumeralAtlas::cell_width +
                                                      x)] =
                    static_cast<std::uint8_t>(
                        std::lround(255.0f * std::clamp(0.5f + 0.5f * within, 0.0f, 1.0f)));
            }
        }
    }
    return atlas;
}

}  // namespace

const NumeralAtlas& numeral_atlas() {
    static const NumeralAtlas atlas = draw_atlas();
    return atlas;
}

}  // namespace eti::render
