// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/head.hpp"

#include <cmath>

#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

/// Widening factor of a cranium of `size`, at a height above its floor.
float cranium_width(float above, float size) {
    return 1.0f + (size - 1.0f) * smoothstep(0.0f, 22.0f, above);
}

}  // namespace

Vec3f to_standard_cranium(const Vec3f& p, float size) {
    if (size == 1.0f || p.z() <= cranium_floor) {
        return p;
    }
    const float above = p.z() - cranium_floor;
    const float wide = cranium_width(above, size);
    return {p.x() / wide, cranium_axis_y + (p.y() - cranium_axis_y) / wide,
            p.z() - (1.0f - 1.0f / size) * above * above / (above + 12.0f)};
}

Vec3f to_scaled_cranium(const Vec3f& p, float size) {
    if (p.z() <= cranium_floor) {
        return p;
    }
    // The height above the floor solves above^2 / size + (12 - usual) above = 12 usual.
    const float usual = p.z() - cranium_floor;
    const float half = 0.5f * (12.0f - usual);
    const float above = size * (std::sqrt(half * half + 12.0f * usual / size) - half);
    const float wide = cranium_width(above, size);
    return {p.x() * wide, cranium_axis_y + (p.y() - cranium_axis_y) * wide, cranium_floor + above};
}

float skin_field(const Vec3f& point, const Vec3f& in_jaw, float cranium_size) {
    const Vec3f p = to_standard_cranium(point, cranium_size);
    const Vec3f q = mirrored(p);
    const float cranium = ellipsoid(p, {0, -18, 47}, {47, 58, 46});
    const float socket = ellipsoid(q, {17, 47, 24}, {11, 7, 8});
    const float face = smooth_difference(ellipsoid(p, {0, 20, 12}, {36, 34, 36}), socket, 8);
    const float lids = ellipsoid(q, {17, 38.5f, 23.5f}, {8.5f, 7.5f, 7});
    const float cheek = ellipsoid(q, {21, 27, -6}, {15, 17, 16});
    const float upper_lip = ellipsoid(p, {0, 47, -1.5f}, {16, 9.5f, 7.5f});
    const float nose = smooth_union(round_cone(p, {0, 48, 26}, {0, 58.5f, 10}, 3, 4.8f),
                                    round_cone(q, {4.6f, 54.5f, 8}, {3.8f, 53.5f, 8}, 3.3f, 3.3f), 3);
    const float nostril = round_cone(q, {2.8f, 56.5f, 2.5f}, {3.0f, 54, 9}, 1.5f, 1.2f);
    float head = smooth_union(smooth_union(cranium, face, 14), lids, 4);
    head = smooth_union(head, smooth_union(cheek, smooth_union(upper_lip, nose, 5), 6), 10);
    head = smooth_difference(head, nostril, 1);
    const float chin = smooth_union(ellipsoid(in_jaw, {0, 40, -21}, {12, 10, 11}),
                                    smooth_union(ellipsoid(in_jaw, {0, 26, -19}, {27, 24, 14}),
                                                 ellipsoid(in_jaw, {0, 47.5f, -11.5f}, {13, 7.5f, 6}), 5),
                                    8);
    const float neck = duct(p, {{-4, 0, 30, 28}, {-8, -40, 27, 27}, {-12, -75, 30, 28}, {-14, -110, 40, 30}});
    const float shoulders = ellipsoid(p, {0, -16, -104}, {78, 34, 34});
    const float ear = smooth_difference(ellipsoid(q, {47, -16, 14}, {3.5f, 9, 14}),
                                        ellipsoid(q, {51, -14, 14}, {3, 5.5f, 9}), 2);
    return smooth_union(smooth_union(smooth_union(head, ear, 3), chin, 7), smooth_union(neck, shoulders, 16),
                        14);
}

}  // namespace eti::patient
