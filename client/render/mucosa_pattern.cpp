// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mucosa_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "common/math/random.hpp"
#include "common/math/units.hpp"

namespace eti::render {
namespace {

// Superficial vessels of laryngeal mucosa: arterioles and venules of 50 to 150 um branch down to capillaries
// of 10 um, which no lens resolves. Numbers of vessels and branches are chosen.
constexpr int trunks = 9;
constexpr float trunk_radius = 50e-6f;  // [m]
constexpr float thinnest = 10e-6f;      // [m], radius at which a vessel is no longer drawn
constexpr float taper_per_m = 60.0f;    // fraction of the radius lost along the way
constexpr float branches_per_m = 700.0f;
constexpr float child_radius = 0.72f;  // of its parent's
// Turns per metre: standard deviation, and the length over which it persists.
constexpr float bend = 700.0f, bend_length = 0.4e-3f;

/// A square of values that repeats.
class Tile {
  public:
    explicit Tile(int side) : side_(side), value_(static_cast<std::size_t>(side * side), 0.0f) {}
    [[nodiscard]] int side() const { return side_; }
    [[nodiscard]] float& at(int x, int y) {
        return value_[static_cast<std::size_t>((y & (side_ - 1)) * side_ + (x & (side_ - 1)))];
    }

  private:
    int side_;
    std::vector<float> value_;
};

/// Adds noise of gradients on a lattice (Perlin 2002) of about this spacing [m]; most of it has wavelengths
/// of one to two spacings.
void add_noise(Tile& tile, float spacing, float amplitude, Random& random) {
    const int cells = std::max(static_cast<int>(std::lround(MucosaPattern::period / spacing)), 2);
    std::vector<std::array<float, 2>> gradients(static_cast<std::size_t>(cells * cells));
    for (auto& gradient : gradients) {
        const float angle = 2.0f * std::numbers::pi_v<float> * random.uniform();
        gradient = {std::cos(angle), std::sin(angle)};
    }
    const auto fade = [](float t) { return t * t * t * (t * (6.0f * t - 15.0f) + 10.0f); };
    for (int y = 0; y < tile.side(); ++y) {
        for (int x = 0; x < tile.side(); ++x) {
            const float u =
                (static_cast<float>(x) + 0.5f) * static_cast<float>(cells) / static_cast<float>(tile.side());
            const float v =
                (static_cast<float>(y) + 0.5f) * static_cast<float>(cells) / static_cast<float>(tile.side());
            const int i = static_cast<int>(u), j = static_cast<int>(v);
            const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
            const auto corner = [&](int a, int b) {
                const auto& g =
                    gradients[static_cast<std::size_t>((j + b) % cells * cells + (i + a) % cells)];
                return g[0] * (s - static_cast<float>(a)) + g[1] * (t - static_cast<float>(b));
            };
            tile.at(x, y) += amplitude * std::lerp(std::lerp(corner(0, 0), corner(1, 0), fade(s)),
                                                   std::lerp(corner(0, 1), corner(1, 1), fade(s)), fade(t));
        }
    }
}

/// A growing vessel; lengths in texels.
struct Vessel {
    float x, y, heading, radius;
    float bending;
    int steps;
    float id;
    bool trunk;
};

/// Draws trees of vessels that taper, branch, and end thin or in another vessel.
void grow_vessels(Tile& blood, Random& random) {
    const int side = blood.side();
    const float texel = MucosaPattern::period / static_cast<float>(side);
    Tile owner(side);
    float next_id = 1.0f;
    std::deque<Vessel> growing;
    for (int k = 0; k < trunks; ++k) {
        growing.push_back(
            {random.uniform() * static_cast<float>(side), random.uniform() * static_cast<float>(side),
             2.0f * std::numbers::pi_v<float> * random.uniform(),
             trunk_radius / texel * (0.6f + 0.4f * random.uniform()), 0.0f, 0, next_id++, true});
    }
    const float persistence = std::exp(-texel / bend_length);
    const float kick = bend * texel * std::sqrt(1.0f - persistence * persistence);
    constexpr float blurred = 1.0f;  // texels, by the tissue above a vessel
    const auto draw = [&](const Vessel& v) {
        const int reach = static_cast<int>(std::ceil(v.radius)) + 2;
        const int cx = static_cast<int>(std::floor(v.x)), cy = static_cast<int>(std::floor(v.y));
        // A thin vessel shows less blood than it is wide, and a trunk rises from the depth.
        constexpr float rise = 50.0f;
        const float most = std::min(1.0f, 0.25f + 0.3f * v.radius) *
                           (v.trunk ? std::min(1.0f, static_cast<float>(v.steps) / rise) : 1.0f);
        for (int y = cy - reach; y <= cy + reach; ++y) {
            for (int x = cx - reach; x <= cx + reach; ++x) {
                const float off =
                    std::hypot(static_cast<float>(x) + 0.5f - v.x, static_cast<float>(y) + 0.5f - v.y);
                float& here = blood.at(x, y);
                here = std::max(here,
                                most * std::clamp((v.radius + blurred - off) / (2.0f * blurred), 0.0f, 1.0f));
                if (off < v.radius + 1.5f) {
                    owner.at(x, y) = v.id;
                }
            }
        }
    };
    while (!growing.empty()) {
        Vessel v = growing.front();
        growing.pop_front();
        while (v.radius * texel > thinnest) {
            v.bending = persistence * v.bending + kick * random.normal();
            v.heading += v.bending;
            v.x += std::cos(v.heading);
            v.y += std::sin(v.heading);
            v.radius *= 1.0f - taper_per_m * texel;
            ++v.steps;
            const float ahead = v.radius + 2.5f;
            const float met = owner.at(static_cast<int>(std::floor(v.x + ahead * std::cos(v.heading))),
                                       static_cast<int>(std::floor(v.y + ahead * std::sin(v.heading))));
            constexpr int clear_of_parent = 14;
            const bool ends = met != 0.0f && met != v.id && v.steps > clear_of_parent;
            draw(v);
            if (ends) {
                break;
            }
            if (v.steps > clear_of_parent && random.uniform() < branches_per_m * texel) {
                const float side_of = random.uniform() < 0.5f ? -1.0f : 1.0f;
                const float angle = (25.0f + 30.0f * random.uniform()) * degree;
                growing.push_back({v.x, v.y, v.heading + side_of * angle, child_radius * v.radius, 0.0f, 0,
                                   next_id++, false});
                v.heading -= 0.3f * side_of * angle;
                v.radius *= 0.93f;
            }
        }
    }
}

std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

}  // namespace

MucosaPattern mucosa_pattern(int side) {
    Random random(1);
    Tile blood(side), height(side), mottling(side);
    grow_vessels(blood, random);
    // Relief between 0.1 and 0.7 mm, about equally steep at each scale: amplitudes in shares of the
    // wavelength.
    for (const float spacing : {0.45e-3f, 0.26e-3f, 0.15e-3f, 0.085e-3f}) {
        add_noise(height, spacing, 0.032f * spacing, random);
    }
    for (const float spacing : {1.5e-3f, 0.8e-3f, 0.35e-3f}) {
        add_noise(mottling, spacing, 0.55f * std::sqrt(spacing / 1.5e-3f), random);
    }
    const float texel = MucosaPattern::period / static_cast<float>(side);
    const auto slope = [&](float before, float after) {
        return 0.5f + 0.5f * (after - before) / (2.0f * texel * MucosaPattern::steepest);
    };
    MucosaPattern pattern{side, {}};
    pattern.texels.reserve(static_cast<std::size_t>(side * side));
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            pattern.texels.push_back({to_byte(blood.at(x, y)),
                                      to_byte(slope(height.at(x - 1, y), height.at(x + 1, y))),
                                      to_byte(slope(height.at(x, y - 1), height.at(x, y + 1))),
                                      to_byte(0.5f + 0.5f * mottling.at(x, y))});
        }
    }
    return pattern;
}

}  // namespace eti::render
