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

/// A sheet across the throat at `anterior`, below `top`, with an opening that is arched above `from`, of half
/// width `wide` and height `high` over it.
float arch(const Vec3f& p, float anterior, float from, float wide, float high, float top) {
    const float above = std::max(p.z() - from, 0.0f) / high;
    const float opening = (std::hypot(p.x() / wide, above) - 1.0f) * wide;
    return smooth_intersection(std::max(std::fabs(p.y() - anterior) - 0.7f, p.z() - top), -opening, 1.0f);
}

}  // namespace

Gums visible_gums(const Vec3f& p, const Vec3f& in_jaw) {
    const Gums plain = gum_fields(p, in_jaw);
    return {plain.upper - segments(mirrored(p)), plain.lower - segments(mirrored(in_jaw))};
}

float visible_palate(const Vec3f& p) {
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
    // The velum's free edge arches upwards on both sides of the uvula.
    const Vec3f flat(p.x() * 0.22f, p.y(), p.z());
    const float edge = -10.2f + 1.3f * smoothstep(1.5f, 7.0f, q.x());
    const float velum = smooth_intersection(
        std::max(
            chain(flat, {{0, 20, 4.6f}, {0, 14, 3.0f}, {0, 9.5f, -1.5f}, {0, 8.2f, -6}, {0, 8.4f, -8.5f}},
                  2.4f, 1.5f),
            q.x() - 12.0f),
        edge - p.z(), 1.2f);
    const float uvula = round_cone(p, {0, 8.6f, -5.5f}, {0, 8.9f, -11.0f}, 1.5f, 1.15f);
    // Palatoglossal arch, down to the tongue's sides, and palatopharyngeal arch, down the pharyngeal wall.
    const float front = arch(p, 12.0f, -12.0f, 11.3f, 12.5f, 0.5f);
    const float back = arch(p, 6.0f + 0.12f * (p.z() + 8.0f), -15.0f, 9.5f, 11.0f, -3.5f);
    const float soft = smooth_union(smooth_union(velum, uvula, 1.2f), std::min(front, back), 1.2f);
    return std::min(hard, soft);
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
