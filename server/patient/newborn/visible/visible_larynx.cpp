// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/visible/visible_larynx.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/math/units.hpp"
#include "server/patient/newborn/larynx.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

float mix(float a, float b, float t) {
    return a + t * (b - a);
}

/// A horizontal section of the laryngeal lumen, from its back (u = -1) to its front (u = 1).
struct VisibleLevel {
    float superior, anterior;  // centre
    float lateral, sagittal;   // semi-axes
    float triangle;            // 1: an apex in front and a base behind; -1 the other way; 0: an ellipse
};

// From the inlet to the subglottis. At the glottis the anterior commissure is an apex, the base is between
// the arytenoids: 5.5 mm long, about 11 mm^2, breathing. The vestibular folds leave more room than the cords,
// so that these are visible between them, and the ventricle more than either: its floor is the cords' upper
// face. The vestibule extends into the plate, which is its anterior wall and remains so when lifted.
constexpr std::array<VisibleLevel, 14> levels = {{{-26.5f, 4.5f, 3.7f, 2.8f, 0.0f},
                                                  {-29.0f, 5.2f, 3.6f, 3.2f, -0.3f},
                                                  {-31.0f, 5.7f, 3.35f, 3.5f, -0.45f},
                                                  {-33.0f, 5.75f, 3.15f, 3.4f, -0.1f},
                                                  {-34.0f, 5.65f, 2.9f, 3.2f, 0.2f},
                                                  {-34.8f, 5.6f, 2.8f, 3.0f, 0.4f},  // vestibular folds
                                                  {-35.3f, 5.55f, 3.2f, 2.95f, 0.38f},
                                                  {-36.0f, 5.55f, 4.1f, 2.95f, 0.4f},  // ventricle
                                                  {-36.7f, 5.58f, 3.7f, 2.9f, 0.6f},
                                                  {-37.15f, 5.6f, 2.6f, 2.78f, 0.95f},
                                                  {glottis_z, glottis_y, 2.3f, glottis_half_length, 1.0f},
                                                  {-38.2f, 5.55f, 2.42f, 2.75f, 0.85f},
                                                  {-39.8f, 5.35f, 2.4f, 2.6f, 0.3f},
                                                  {-42.0f, 5.1f, 2.4f, 2.4f, 0.0f}}};

using LevelValue = float VisibleLevel::*;

/// Slope of a value at a level for a monotone cubic through the levels (Fritsch & Butland 1984): a smoothstep
/// between each two would terrace the walls.
float slope_at(std::size_t i, LevelValue value) {
    if (i == 0 || i + 1 == levels.size()) {
        return 0.0f;
    }
    const auto secant = [&](std::size_t k) {
        return (levels[k + 1].*value - levels[k].*value) / (levels[k + 1].superior - levels[k].superior);
    };
    const float before = secant(i - 1), after = secant(i);
    return before * after <= 0.0f ? 0.0f : 2.0f * before * after / (before + after);
}

std::array<VisibleLevel, levels.size()> level_slopes() {
    std::array<VisibleLevel, levels.size()> slopes{};
    for (std::size_t i = 0; i < levels.size(); ++i) {
        for (const LevelValue value : {&VisibleLevel::anterior, &VisibleLevel::lateral,
                                       &VisibleLevel::sagittal, &VisibleLevel::triangle}) {
            slopes[i].*value = slope_at(i, value);
        }
    }
    return slopes;
}

VisibleLevel level_at(float superior) {
    static const std::array slopes = level_slopes();
    std::size_t below = 1;
    while (below + 1 < levels.size() && levels[below].superior > superior) {
        ++below;
    }
    const VisibleLevel &a = levels[below - 1], &b = levels[below];
    const float length = b.superior - a.superior;
    const float t = std::clamp((superior - a.superior) / length, 0.0f, 1.0f);
    const float to_b = t * t * (3.0f - 2.0f * t);
    const float from_a = length * t * (1.0f - t) * (1.0f - t), from_b = length * t * t * (t - 1.0f);
    VisibleLevel level{superior, 0.0f, 0.0f, 0.0f, 0.0f};
    for (const LevelValue value : {&VisibleLevel::anterior, &VisibleLevel::lateral, &VisibleLevel::sagittal,
                                   &VisibleLevel::triangle}) {
        level.*value =
            mix(a.*value, b.*value, to_b) + from_a * slopes[below - 1].*value + from_b * slopes[below].*value;
    }
    return level;
}

/// Half width at u, as a fraction of the maximum.
float profile(float u, float triangle) {
    const float round = std::sqrt(std::max(1.0f - u * u, 0.0f));
    const float to_apex = triangle < 0.0f ? -u : u;
    const float pointed =
        0.5f * (1.0f - to_apex) * std::sqrt(std::clamp((1.0f + to_apex) / 0.35f, 0.0f, 1.0f));
    return mix(round, pointed, std::fabs(triangle));
}

/// Bulge of the vocal process [mm], where a cord's ligament ends at the arytenoid: above the glottis's plane,
/// whose contour it leaves as published.
float vocal_process(float u, float superior) {
    const float along = (u + 0.4f) / 0.2f, above = (superior - glottis_z - 0.35f) / 0.25f;
    return 0.2f * std::exp(-along * along - above * above) *
           smoothstep(glottis_z, glottis_z + 0.15f, superior);
}

float glottic_lumen(const Vec3f& p) {
    const VisibleLevel level = level_at(p.z());
    const float u = (p.y() - level.anterior) / level.sagittal;
    const float width = level.lateral * profile(u, level.triangle) - vocal_process(u, p.z());
    const float beyond = std::max(std::fabs(u) - 1.0f, 0.0f) * level.sagittal;
    const float beside = std::fabs(p.x()) - width;
    // Walls are inclined by up to 45 degrees: 0.7 times the transverse offset approximates the distance.
    const float across = beyond > 0.0f ? std::hypot(beyond, std::fabs(p.x()))
                                       : 0.7f * std::max(beside, (std::fabs(u) - 1.0f) * level.sagittal);
    return std::max({across, p.z() - levels.front().superior, levels.back().superior - p.z()});
}

/// Trachea from subglottis to carina, with slight anterior rings.
float windpipe(const Vec3f& p) {
    const float rings =
        0.12f * std::cos(2.0f * std::numbers::pi_v<float> * p.z() / 2.3f) * smoothstep(-46.0f, -50.0f, p.z());
    const float tube = duct(p, {{5.1f, -42, 2.4f, 2.4f},
                                {4.4f, -46, 2.4f, 2.4f},
                                {3.6f, -50, 2.6f, 2.5f},
                                {-0.6f, -70, 2.6f, 2.5f},
                                {-3.9f, -88.5f, 2.6f, 2.5f}});
    const float bronchi = round_cone(mirrored(p), {0, -3.8f, -87}, {7, -5.2f, -96}, 2.2f, 2.0f);
    return smooth_union(tube + rings, bronchi, 0.4f);
}

const Vec3f plate_base(0, 9.8f, -33.5f);
const Vec3f plate_tip(0, 3.4f, -20.2f);

// The vertical axis about which the inlet's border runs.
constexpr float inlet_axis_y = 5.4f;

/// Height of the inlet's border by the angle around its axis: from the interarytenoid notch, behind, over the
/// corniculate and cuneiform tubercles along the aryepiglottic fold to the plate's edge.
float upper_border(const Vec3f& q) {
    struct Crest {
        float around_deg, superior;
    };
    constexpr std::array<Crest, 9> crests = {{{0.0f, -32.9f},
                                              {24.0f, -31.4f},
                                              {40.0f, -31.7f},
                                              {56.0f, -31.0f},
                                              {74.0f, -29.7f},
                                              {92.0f, -28.1f},
                                              {110.0f, -27.7f},
                                              {135.0f, -28.2f},
                                              {180.0f, -28.2f}}};
    const float around = std::atan2(q.x(), inlet_axis_y - q.y()) / degree;
    std::size_t next = 1;
    while (next + 1 < crests.size() && crests[next].around_deg < around) {
        ++next;
    }
    return mix(crests[next - 1].superior, crests[next].superior,
               smoothstep(crests[next - 1].around_deg, crests[next].around_deg, around));
}

float glosso_epiglottic_folds(const Vec3f& p) {
    const Vec3f q = mirrored(p);
    // Ridges on the floor of the valleculae: one in the midline, one to each pharyngeal wall.
    const auto ridge = [&](const Vec3f& plate, const Vec3f& far, float half) {
        const Vec3f d = far - plate;
        const float t = std::clamp(
            ((q.x() - plate.x()) * d.x() + (q.y() - plate.y()) * d.y()) / (d.x() * d.x() + d.y() * d.y()),
            0.0f, 1.0f);
        const float off = std::hypot(q.x() - plate.x() - t * d.x(), q.y() - plate.y() - t * d.y());
        // Its crest sags between its ends.
        const float crest = plate.z() + t * d.z() - 2.4f * t * (1.0f - t);
        return smooth_intersection(off - half, q.z() - crest, 1.6f * half);
    };
    return std::min(ridge({0.0f, 7.6f, -26.6f}, {0.0f, 12.5f, -25.4f}, 0.45f),
                    ridge({3.9f, 6.0f, -27.6f}, {9.5f, 7.0f, -25.6f}, 0.9f));
}

}  // namespace

float visible_epiglottis(const Vec3f& p) {
    const Vec3f axis = (plate_tip - plate_base).normalized();
    const float length = (plate_tip - plate_base).norm();
    const float along = (p - plate_base).dot(axis);
    const float behind =
        (p.y() - plate_base.y()) * -axis.z() + (p.z() - plate_base.z()) * axis.y();  // positive: posterior
    const float u = std::clamp(along / length, 0.0f, 1.0f);
    // The outline: a spatula, widest above the middle of its blade.
    const float blade = (std::hypot(p.x() / 4.4f, (along - 0.62f * length) / (0.38f * length)) - 1.0f) * 4.4f;
    const float stalk = std::hypot(p.x(), along - std::clamp(along, 0.5f, 0.5f * length)) -
                        (1.5f + 1.4f * smoothstep(0.0f, 0.5f, u));
    const float outline = smooth_union(blade, stalk, 2.0f);
    // The omega: sides curl backwards, more so towards the tip.
    const float roll = mix(0.07f, 0.15f, smoothstep(0.1f, 0.8f, u));
    const float sheet = roll * p.x() * p.x() - 0.5f * std::sin(std::numbers::pi_v<float> * u) +
                        0.9f * smoothstep(0.75f, 1.0f, u);
    const float slope = 2.0f * roll * p.x();
    const float off = (behind - sheet) / std::sqrt(1.0f + slope * slope);
    const float plate =
        std::hypot(std::max(outline + 0.45f, 0.0f), std::max(std::fabs(off) - 0.15f, 0.0f)) - 0.45f;
    // The tubercle on its laryngeal face.
    const float tubercle =
        std::hypot(p.x() / 1.3f, (along - 0.3f * length) / 2.0f, (off - 0.1f) / 0.9f) - 1.0f;
    return 0.85f * smooth_union(plate, 0.9f * tubercle, 0.8f);
}

float visible_laryngeal_solid(const Vec3f& p) {
    const Vec3f q = mirrored(p);
    // One wall bounds the inlet and thickens downwards: the folds, and behind them the mucosa between and
    // over the arytenoids. The tubercles are swellings of its border.
    const float lower = smoothstep(-29.0f, -36.0f, q.z());
    const float wide = mix(4.75f, 5.6f, lower), deep = mix(4.7f, 5.6f, lower);
    const float around = (std::hypot(q.x() / wide, (q.y() - inlet_axis_y) / deep) - 1.0f) * deep;
    const float wall = smooth_intersection(around, 0.8f * (q.z() - upper_border(q)), 1.2f);
    const float corniculate = ellipsoid(q, {1.6f, 1.7f, -31.7f}, {1.05f, 1.15f, 1.35f});
    const float cuneiform = ellipsoid(q, {3.55f, 2.7f, -31.2f}, {1.1f, 1.2f, 1.45f});
    const float box = smooth_intersection(ellipsoid(p, {0, 5.3f, -39}, {6.6f, 6.4f, 8.5f}), p.z() + 32.6f, 2);
    const float larynx = smooth_union(smooth_union(wall, std::min(corniculate, cuneiform), 0.9f), box, 2.5f);
    return smooth_union(larynx, glosso_epiglottic_folds(p), 1.2f);
}

float visible_laryngeal_lumen(const Vec3f& p) {
    return std::min(glottic_lumen(p), windpipe(p));
}

bool on_vocal_cord(const Vec3f& p) {
    // The free edge and as much of the ventricle's floor and of the cord's lower face beside it.
    constexpr float breadth = 0.9f;
    const VisibleLevel edge = level_at(glottis_z);
    const float u = (p.y() - edge.anterior) / edge.sagittal;
    const float beside = std::fabs(p.x()) - edge.lateral * profile(u, edge.triangle);
    return p.z() > -38.5f && p.z() < -36.6f && u > -0.85f && u < 1.35f && beside < breadth;
}

float plate_coupling(const Vec3f& p, float plate, float solid) {
    const float near = 1.0f - smoothstep(0.4f, 3.6f, plate);
    const float above = smoothstep(-35.5f, -32.5f, p.z());  // not below its root
    return near * above * (1.0f - smoothstep(0.4f, 1.2f, solid));
}

}  // namespace eti::patient
