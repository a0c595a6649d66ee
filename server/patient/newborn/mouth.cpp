// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/mouth.hpp"

#include <algorithm>
#include <cmath>

#include "server/patient/newborn/jaw.hpp"
#include "server/patient/newborn/larynx.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

Gums gum_fields(const Vec3f& p, const Vec3f& in_jaw) {
    return {
        chain(mirrored(p),
              {{15.5f, 20, -2}, {15, 29, -2.5f}, {12.5f, 37, -3}, {7.5f, 43.5f, -3}, {0, 45.5f, -3}}, 3.9f,
              3.9f),
        chain(mirrored(in_jaw),
              {{15, 20, -9.5f}, {14.5f, 28, -9.5f}, {12, 35.5f, -9.5f}, {7, 41.5f, -9.5f}, {0, 43.5f, -9.5f}},
              3.7f, 3.7f)};
}

float oral_vault(const Vec3f& p) {
    return ellipsoid(p, {0, 27, -6}, {13.5f, 22, 9.5f});
}

float hard_palate(const Vec3f& p) {
    const float vault = oral_vault(p);
    const float plate = smooth_intersection(vault - 3.4f, -(vault - 1.2f), 0.5f);
    return smooth_intersection(plate, std::max(18.5f - p.y(), -0.5f - p.z()), 0.5f);
}

float soft_palate(const Vec3f& p) {
    const Vec3f flat(p.x() * 0.22f, p.y(), p.z());
    const float velum = std::max(
        chain(flat, {{0, 20, 4.6f}, {0, 14, 3.0f}, {0, 9.5f, -1.5f}, {0, 8.2f, -6}, {0, 8.4f, -8.5f}}, 2.4f,
              1.7f),
        std::fabs(p.x()) - 12.0f);
    return smooth_union(velum, round_cone(p, {0, 8.4f, -6.5f}, {0, 8.6f, -10.5f}, 1.9f, 1.5f), 1.5f);
}

float tongue_shape(const Vec3f& in_jaw, float scale) {
    const Vec3f t = tongue_centre + (in_jaw - tongue_centre) / scale;
    float shape = smooth_union(
        ellipsoid(t, {0, 23.5f, -12.5f}, {13.5f, 19, 13}),
        round_cone({t.x() * 0.55f, t.y(), t.z()}, {0, 28, -8.5f}, {0, 39.5f, -8.2f}, 7.0f, 3.6f), 6);
    shape = smooth_union(shape, ellipsoid(t, {0, 17.0f, -20.5f}, {11.5f, 8.2f, 11.5f}), 6) * scale;
    // Median sulcus.
    return shape + 0.9f * std::exp(-t.x() * t.x() / 4.0f) * smoothstep(-14, -4, t.z());
}

float sublingual_space(const Vec3f& in_jaw) {
    const float space = ellipsoid(in_jaw, {0, 38.6f, -12.2f}, {9, 5, 1.8f});
    // It is attached to the tongue well behind the tip and to the floor, not to the gum's ridge (scored as
    // normal by Hazelbaker's tool; Amir 2006, Int Breastfeed J 1:3). Thicker than in life: a thinner fold
    // would fall between the nodes of the surface's grid, 1 mm apart.
    const float frenulum =
        std::max(std::fabs(in_jaw.x()) - 0.9f, in_jaw.y() - (37.6f + 0.25f * (-12.2f - in_jaw.z())));
    return smooth_difference(space, frenulum, 0.6f);
}

float throat_and_mouth(const Vec3f& p, const Vec3f& in_jaw, float rest_jaw_deg, float mouth_width) {
    const Vec3f q = mirrored(p);
    const float gap = 2.0f * std::sin(rest_jaw_deg * degree / 2.0f) * 48.0f;
    // Pharynx from the nasopharynx to the hypopharynx.
    float air = duct(p, {{9, 6, 9, 6.5f}, {4.6f, -6, 10, 4.6f}, {5.0f, -20, 10, 5.0f}, {4.2f, -31, 9, 4.2f}});
    air = smooth_union(air, ellipsoid(p, {0, 9, 8}, {9, 7, 9}), 4);
    // Mouth: vault above, floor in the jaw's frame, lips and vestibule half-way between.
    const float upper = std::max(oral_vault(p), 8.0f - p.y());
    const float lower = ellipsoid(in_jaw, {0, 26, -8}, {13, 21, 10});
    const Vec3f half = turn_about_jaw(p, rest_jaw_deg * 0.5f);
    float middle = ellipsoid(half, {0, 28, -7}, {17, 24, 6.5f + gap * 0.33f});
    const float slit = std::max(gap * 0.36f, 0.4f);
    const float corner = 12.0f * mouth_width;
    const float rima = std::max((std::sqrt(half.x() * half.x() / (corner * corner) +
                                           (half.z() + 6.3f) * (half.z() + 6.3f) / (slit * slit)) -
                                 1.0f) *
                                    std::min(corner, slit),
                                36.0f - half.y());
    middle = smooth_union(middle, rima, 2.5f);
    const float vestibule =
        chain({q.x(), half.y(), half.z()},
              {{19.5f, 24, -6}, {18.5f, 33, -6}, {14.5f, 42, -6}, {8, 48.5f, -6}, {0, 50.3f, -6}},
              0.7f + gap * 0.02f, 0.7f + gap * 0.05f);
    middle = smooth_union(middle, vestibule, 1);
    float mouth = smooth_union(smooth_union(upper, lower, 3), middle, 3);
    mouth = smooth_union(mouth, ellipsoid(p, {0, 10, -12}, {11, 8, 8}), 4);  // fauces
    air = smooth_union(air, mouth, 2);
    // Vallecula, space anterior to the epiglottis, piriform recesses, hypopharynx, oesophagus.
    air = smooth_union(air, ellipsoid(p, {0, 8.6f, -24.5f}, {7.5f, 3.6f, 6}), 1.5f);
    air = smooth_union(air, ellipsoid(q, {6.3f, 2.6f, -32.5f}, {2.6f, 3.0f, 6.5f}), 1.5f);
    air = smooth_union(air, duct(p, {{2.0f, -28, 8.5f, 2.2f}, {-0.6f, -35, 7, 1.3f}, {-2.4f, -42, 4, 1.1f}}),
                       1);
    air = smooth_union(air,
                       duct(p, {{-2.6f, -41, 3.4f, 1.4f},
                                {-4.9f, -50, 3.2f, 1.6f},
                                {-8.6f, -72, 3.2f, 1.6f},
                                {-12.0f, -96, 3.2f, 1.6f}}),
                       0.5f);
    return air;
}

Cavities cavity_fields(const Vec3f& p, const Vec3f& in_jaw, const Gums& gums, float rest_jaw_deg,
                       float mouth_width) {
    float air = throat_and_mouth(p, in_jaw, rest_jaw_deg, mouth_width);
    const float larynx = laryngeal_solid(p);
    const float organs = std::min({hard_palate(p), soft_palate(p), gums.upper, gums.lower, larynx});
    air = smooth_difference(air, organs, 0.5f);
    const LaryngealFields fields = laryngeal_fields(p, larynx);
    return {smooth_union(air, fields.lumen, 0.5f), fields.wall, fields.cricoid};
}

}  // namespace eti::patient
