// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/visible/visible_larynx.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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
// the arytenoids: 5.5 mm long, about 11 mm^2, breathing. False cords and ventricle are wider, so that the
// upper faces of the true cords are visible between them. The vestibule extends into the plate, which is its
// anterior wall and remains so when lifted.
constexpr std::array<VisibleLevel, 11> levels = {{{-26.5f, 4.5f, 3.7f, 2.8f, 0.0f},
                                                  {-29.0f, 5.2f, 3.6f, 3.2f, -0.3f},
                                                  {-31.0f, 5.7f, 3.35f, 3.5f, -0.45f},
                                                  {-33.4f, 5.85f, 3.1f, 3.45f, 0.0f},
                                                  {-34.7f, 5.65f, 3.0f, 3.15f, 0.35f},  // false cords
                                                  {-35.9f, 5.7f, 4.0f, 3.2f, 0.3f},     // ventricle
                                                  {-36.5f, 5.7f, 3.7f, 3.15f, 0.4f},
                                                  {glottis_z, glottis_y, 2.3f, glottis_half_length, 1.0f},
                                                  {-38.1f, 5.55f, 2.3f, 2.75f, 0.9f},
                                                  {-39.8f, 5.35f, 2.4f, 2.6f, 0.3f},
                                                  {-42.0f, 5.1f, 2.4f, 2.4f, 0.0f}}};

/// Half width at u, as a fraction of the maximum.
float profile(float u, float triangle) {
    const float round = std::sqrt(std::max(1.0f - u * u, 0.0f));
    const float to_apex = triangle < 0.0f ? -u : u;
    const float pointed =
        0.5f * (1.0f - to_apex) * std::sqrt(std::clamp((1.0f + to_apex) / 0.35f, 0.0f, 1.0f));
    return mix(round, pointed, std::fabs(triangle));
}

float glottic_lumen(const Vec3f& p) {
    const auto* below =
        std::ranges::find_if(levels.begin() + 1, levels.end() - 1,
                             [&](const VisibleLevel& level) { return level.superior <= p.z(); });
    const VisibleLevel& a = *(below - 1);
    const VisibleLevel& b = *below;
    const float t = smoothstep(a.superior, b.superior, p.z());
    const float sagittal = mix(a.sagittal, b.sagittal, t);
    const float u = (p.y() - mix(a.anterior, b.anterior, t)) / sagittal;
    const float width = mix(a.lateral, b.lateral, t) * profile(u, mix(a.triangle, b.triangle, t));
    const float beyond = std::max(std::fabs(u) - 1.0f, 0.0f) * sagittal;
    const float beside = std::fabs(p.x()) - width;
    // Walls are inclined by up to 45 degrees: 0.7 times the transverse offset approximates the distance.
    const float across = beyond > 0.0f ? std::hypot(beyond, std::fabs(p.x()))
                                       : 0.7f * std::max(beside, (std::fabs(u) - 1.0f) * sagittal);
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

/// Height of the larynx's upper border at a position, from the arytenoids up to the epiglottis's sides.
float upper_border(const Vec3f& q) {
    const float notch = (1.0f - smoothstep(0.4f, 1.7f, q.x())) * (1.0f - smoothstep(2.4f, 4.2f, q.y()));
    return -30.9f + 2.9f * smoothstep(2.4f, 5.6f, q.y()) - 2.4f * notch;
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
        return smooth_intersection(off - half, q.z() - crest, 0.8f);
    };
    return std::min(ridge({0.0f, 7.6f, -26.6f}, {0.0f, 12.5f, -25.4f}, 0.45f),
                    ridge({3.9f, 6.0f, -27.6f}, {9.5f, 7.0f, -25.2f}, 0.5f));
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
    // The arytenoids with the corniculate tubercles on them, and the cuneiform ones beside, within the folds.
    const float arytenoid = ellipsoid(q, {2.4f, 2.3f, -34.2f}, {2.0f, 1.8f, 3.4f});
    const float corniculate = ellipsoid(q, {1.65f, 1.7f, -31.0f}, {1.1f, 1.2f, 1.35f});
    const float cuneiform = ellipsoid(q, {3.5f, 2.9f, -30.3f}, {1.0f, 1.2f, 1.5f});
    const float posterior = ellipsoid(p, {0, 1.7f, -36.2f}, {2.9f, 1.3f, 2.8f});
    const float around = (std::hypot(q.x() / 4.9f, (q.y() - 5.4f) / 4.6f) - 1.0f) * 4.6f;
    const float wall = smooth_intersection(around, q.z() - upper_border(q), 1.1f);
    const float box = smooth_intersection(ellipsoid(p, {0, 5.3f, -39}, {6.6f, 6.4f, 8.5f}), p.z() + 31.8f, 2);
    const float knobs = smooth_union(smooth_union(arytenoid, corniculate, 0.7f),
                                     smooth_union(cuneiform, posterior, 0.7f), 0.6f);
    const float larynx = smooth_union(smooth_union(wall, knobs, 0.5f), box, 1.5f);
    return smooth_union(larynx, glosso_epiglottic_folds(p), 0.7f);
}

float visible_laryngeal_lumen(const Vec3f& p) {
    return std::min(glottic_lumen(p), windpipe(p));
}

bool on_vocal_cord(const Vec3f& p) {
    return p.z() > -38.9f && p.z() < -36.0f && p.y() > 3.3f && p.y() < 9.3f && std::fabs(p.x()) < 3.4f;
}

float plate_coupling(const Vec3f& p, float plate, float solid) {
    const float near = 1.0f - smoothstep(0.4f, 3.6f, plate);
    const float above = smoothstep(-35.5f, -32.5f, p.z());  // not below its root
    return near * above * (1.0f - smoothstep(0.4f, 1.2f, solid));
}

}  // namespace eti::patient
