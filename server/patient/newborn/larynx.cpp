// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/larynx.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

// From the carina to the subglottis, which is circular: 4.8 mm in diameter.
float tracheal_lumen(const Vec3f& p) {
    return duct(p, {{5.1f, -42, 2.4f, 2.4f},
                    {4.4f, -46, 2.4f, 2.4f},
                    {3.6f, -50, 2.6f, 2.5f},
                    {-0.6f, -70, 2.6f, 2.5f},
                    {-3.9f, -88.5f, 2.6f, 2.5f}});
}

/// A horizontal section of the laryngeal lumen.
struct LarynxLevel {
    float superior, anterior;  // centre
    float lateral, sagittal;   // semi-axes
    float taper;               // fraction by which the width decreases towards the front
};

// From the vestibule to the subglottis. No measurements of the extent of false cords and ventricle in
// newborns are known to us; that false cords leave more room than true ones, and the ventricle more than
// either, is anatomy. The cords are abducted as for a tube. From them to the cricoid the lumen widens
// sideways (Litman 2003, Anesthesiology 98:41). Crests are 3 mm apart, because the surface's grid has a
// spacing of 1 mm.
constexpr std::array<LarynxLevel, 7> larynx_levels = {{{-31.0f, 5.45f, 3.35f, 3.2f, 0.0f},
                                                       {-32.6f, 5.55f, 3.25f, 3.15f, 0.0f},
                                                       {-34.5f, 5.7f, 2.95f, 3.1f, 0.2f},   // false cords
                                                       {-36.0f, 5.75f, 3.75f, 3.1f, 0.1f},  // ventricle
                                                       {glottis_z, 5.66f, 2.95f, 3.08f, 0.5f},
                                                       {-39.5f, 5.45f, 2.6f, 2.9f, 0.2f},
                                                       {-42.0f, 5.1f, 2.4f, 2.4f, 0.0f}}};

/// Not a duct, whose segments end in caps: features of the lumen are lower than they are wide.
float laryngeal_lumen(const Vec3f& p) {
    const auto* below =
        std::ranges::find_if(larynx_levels.begin() + 1, larynx_levels.end() - 1,
                             [&](const LarynxLevel& level) { return level.superior <= p.z(); });
    const LarynxLevel& a = *(below - 1);
    const LarynxLevel& b = *below;
    const float t = smoothstep(a.superior, b.superior, p.z());
    const auto between = [t](float from, float to) { return from + t * (to - from); };
    const float sagittal = between(a.sagittal, b.sagittal);
    const float u = (p.y() - between(a.anterior, b.anterior)) / sagittal;
    const float lateral = between(a.lateral, b.lateral) *
                          (1.0f - between(a.taper, b.taper) * 0.5f * (1.0f + std::clamp(u, -1.0f, 1.0f)));
    const float across = (std::hypot(p.x() / lateral, u) - 1.0f) * std::min(lateral, sagittal);
    return std::max({across, p.z() - larynx_levels.front().superior, larynx_levels.back().superior - p.z()});
}

// The signet ring around the subglottis: a low arch in front, a taller and thicker lamina behind that reaches
// up to the arytenoids. Proportions are chosen.
float cricoid_field(const Vec3f& p) {
    const Vec3f off = p - Vec3f(0.0f, 4.9f, 0.0f);
    const float behind = smoothstep(-0.2f, 0.9f, -off.y() / std::max(std::hypot(off.x(), off.y()), 0.1f));
    const float thickness = 1.2f + 0.9f * behind;
    const float lower = -44.3f - 0.4f * behind;
    const float upper = -42.1f + 3.9f * behind;
    const float outside = tracheal_lumen({p.x(), p.y(), std::min(p.z(), -42.0f)});
    return std::max({outside - thickness, p.z() - upper, lower - p.z()});
}

}  // namespace

float epiglottis_field(const Vec3f& p) {
    // A plate curved along its length and omega-shaped across, as in the newborn.
    const Vec3f base(0, 9.8f, -33.5f);
    const Vec3f tip(0, 3.4f, -20.2f);
    const Vec3f axis = (tip - base).normalized();
    const float length = (tip - base).norm();
    const float along = (p - base).dot(axis);
    const float across =
        (p.y() - base.y()) * -axis.z() + (p.z() - base.z()) * axis.y();  // positive: posterior
    const float u = std::clamp(along / length, 0.0f, 1.0f);
    const float half_width = 2.2f + 3.0f * std::sin(3.0f * std::min(u * 0.62f + 0.12f, 1.0f));
    const float bend = 0.085f * p.x() * p.x() - 0.5f * std::sin(3.14f * u);
    const float outside_x = std::max(std::fabs(p.x()) - half_width, 0.0f);
    const float outside_along = std::max({-along, along - length, 0.0f});
    const float outside_thick = std::max(std::fabs(across - bend) - 0.45f, 0.0f);
    return 0.85f *
           (std::sqrt(outside_x * outside_x + outside_along * outside_along + outside_thick * outside_thick) -
            0.55f);
}

float laryngeal_solid(const Vec3f& p) {
    const Vec3f q = mirrored(p);
    // The larynx protrudes into the pharynx; arytenoids and aryepiglottic folds bound its inlet. Behind them
    // a slit remains, through which a tube advanced blindly enters the gullet.
    const float arytenoid = ellipsoid(q, {2.9f, 2.2f, -33.4f}, {2.2f, 1.8f, 2.8f});
    const float interarytenoid = ellipsoid(p, {0, 1.5f, -36.2f}, {3.2f, 1.6f, 3.0f});
    const float fold = round_cone(q, {4.6f, 6.2f, -27.2f}, {3.6f, 2.2f, -32.2f}, 0.9f, 1.2f);
    const float box = smooth_intersection(ellipsoid(p, {0, 5.3f, -39}, {6.6f, 6.4f, 8.5f}), p.z() + 31.5f, 2);
    return smooth_union(smooth_union(arytenoid, smooth_union(fold, interarytenoid, 1), 1), box, 1.5f);
}

LaryngealFields laryngeal_fields(const Vec3f& p, float solid) {
    const float inlet = duct(p, {{5.3f, -28.5f, 3.8f, 3.4f}, {5.4f, -31.5f, 3.3f, 3.2f}});
    const float trachea = tracheal_lumen(p);
    const float bronchi = round_cone(mirrored(p), {0, -3.8f, -87}, {7, -5.2f, -96}, 2.2f, 2.0f);
    const float lumen = std::min({inlet, laryngeal_lumen(p), smooth_union(trachea, bronchi, 1)});
    // Mucosa and submucosa between ring and lumen.
    const float cricoid = smooth_difference(cricoid_field(p), lumen - 0.3f, 0.3f);
    const float wall = std::min(std::max(smooth_union(trachea - 2.0f, solid, 1), p.z() + 26.0f), cricoid);
    return {lumen, wall, cricoid};
}

}  // namespace eti::patient
