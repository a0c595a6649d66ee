// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/visible/visible_mouth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

constexpr float turn = 2.0f * std::numbers::pi_v<float>;

/// Swelling of a ridge over its tooth buds, by the angle around the arch's centre.
float segments(const Vec3f& q) {
    const float around = std::atan2(q.x(), q.y() - 22.0f);
    return 0.28f * std::cos(turn * around / 0.36f + 0.5f * turn) * smoothstep(14.0f, 24.0f, q.y());
}

// The soft palate rests on the tongue, and its parts are placed by their distance from it [mm]: where a large
// tongue cut it, thin flaps remained, which a lift turned over.
constexpr float tongue_gap = 0.35f;  // between them: a fold of the surface, not a contact
constexpr float sheet_half = 0.8f;   // half thickness of velum and free edge
constexpr float uvula_centre = 1.05f, uvula_radius = 0.95f;
constexpr float room_behind = 1.5f;  // between velum and posterior wall

float uvula(const Vec3f& p, float tongue) {
    // Behind the tongue, not before its tip.
    const float off = std::max({-12.4f - p.z(), p.z() + 7.0f, p.y() - 12.5f, 0.0f});
    return std::hypot(p.x(), tongue - (tongue_gap + uvula_centre), off) -
           (uvula_radius + 0.2f * smoothstep(-8.0f, -12.0f, p.z()));
}

/// Velum, uvula, and to either side the palatoglossal arch, down to the tongue's flank, and the
/// palatopharyngeal arch, down the pharyngeal wall. `tongue`: distance from it.
float visible_soft_palate(const Vec3f& p, float tongue) {
    const Vec3f q = mirrored(p);
    const Vec3f flat(p.x() * 0.22f, p.y(), p.z());
    const float root = smooth_intersection(
        chain(flat, {{0, 20, 4.6f}, {0, 14, 3.0f}, {0, 9.5f, -1.5f}, {0, 8.2f, -5.0f}}, 2.2f, 1.4f),
        q.x() - 12.0f, 1.2f);
    // The free edge arches upwards on both sides of the uvula.
    const float edge = -9.6f + 1.2f * smoothstep(1.0f, 4.0f, q.x()) - 3.2f * smoothstep(4.0f, 9.0f, q.x());
    float sheet = std::fabs(tongue - (tongue_gap + sheet_half)) - sheet_half;
    sheet = smooth_intersection(sheet, edge - p.z(), 1.2f);
    sheet = smooth_intersection(smooth_intersection(sheet, p.y() - 12.5f, 2.0f), q.x() - 12.0f, 1.2f);
    const float front =
        chain(q, {{7, 12, 1}, {10.6f, 12, -5}, {11.6f, 12.5f, -12}, {10.8f, 13, -18}}, 1.3f, 1.1f);
    const float back =
        chain(q, {{5, 3.2f, -8}, {8.2f, 2.6f, -12.5f}, {9, 2.4f, -18}, {8.6f, 1.6f, -25}}, 1.3f, 1.0f);
    const float arched = smooth_union(smooth_union(root, sheet, 1.5f), std::min(front, back), 2.2f);
    return smooth_intersection(smooth_union(arched, uvula(p, tongue), 1.2f), tongue_gap - tongue, 0.7f);
}

}  // namespace

Gums visible_gums(const Vec3f& p, const Vec3f& in_jaw) {
    const Gums plain = gum_fields(p, in_jaw);
    return {plain.upper - segments(mirrored(p)), plain.lower - segments(mirrored(in_jaw))};
}

float visible_palate(const Vec3f& p, float tongue) {
    const Vec3f q = mirrored(p);
    // Rugae: four ridges to either side, curved, and the raphe between them.
    const float vault = oral_vault(p);
    const float wave = std::cos(turn * (p.y() - 0.02f * p.x() * p.x() - 31.5f) / 3.3f);
    const float rugae = 0.45f * std::max(wave, -0.2f) * smoothstep(29.0f, 31.5f, p.y()) *
                        (1.0f - smoothstep(40.0f, 43.0f, p.y())) * smoothstep(0.5f, 1.6f, q.x()) *
                        (1.0f - smoothstep(8.0f, 10.5f, q.x()));
    const float raphe = 0.35f * std::exp(-p.x() * p.x() / 0.6f) * smoothstep(20.0f, 26.0f, p.y());
    const float plate = smooth_intersection(vault - 3.4f, -(vault - 1.2f + rugae + raphe), 0.5f);
    const float hard = smooth_intersection(plate, std::max(18.5f - p.y(), -0.5f - p.z()), 0.5f);
    return std::min(hard, visible_soft_palate(p, tongue));
}

float room_of_velum(const Vec3f& p, float tongue) {
    const float behind = tongue - (tongue_gap + 2.0f * sheet_half + room_behind);
    const float middle =
        smooth_intersection(smooth_intersection(behind, p.y() - 8.0f, 1.0f), std::fabs(p.x()) - 6.5f, 2.0f);
    return std::max({middle, -15.0f - p.z(), p.z() - 2.0f});
}

float visible_tongue(const Vec3f& in_tongue, float scale) {
    const float tongue = tongue_shape(in_tongue, scale);
    // The sulcus runs from behind the tip to the foramen caecum, narrower than the groove around it.
    const Vec3f t = tongue_centre + (in_tongue - tongue_centre) / scale;
    const float sulcus = 0.45f * std::exp(-t.x() * t.x() / 0.5f) * smoothstep(-12.0f, -5.0f, t.z()) *
                         smoothstep(12.0f, 18.0f, t.y()) * (1.0f - smoothstep(38.0f, 42.0f, t.y()));
    return std::max(tongue + sulcus, -sublingual_space(in_tongue));
}

}  // namespace eti::patient
