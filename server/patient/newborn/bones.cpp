// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/bones.hpp"

#include <algorithm>
#include <cmath>

#include "server/patient/newborn/head.hpp"
#include "server/patient/newborn/mouth.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

float skull_field(const Vec3f& point, float cranium_size) {
    const Vec3f p = to_standard_cranium(point, cranium_size);
    const Vec3f q = mirrored(p);
    const float cranium = ellipsoid(p, {0, -18, 47}, {47, 58, 46});
    float vault = std::max(cranium + 3.0f, -(cranium + 5.6f));
    const float base =
        p.y() > -20 ? 20 + (p.y() + 20) * 0.28f : 14 + std::pow((-20 - p.y()) / 38.0f, 2.0f) * 16;
    vault = std::max(vault, base - 4 - p.z());
    if (p.z() > 70) {  // anterior fontanelle
        vault = std::max(vault, 11.0f - std::fabs(p.x()) - std::fabs(p.y() - 14) * 0.8f);
    }
    const float floor = chain({std::max(q.x() - 18.0f, 0.0f), p.y(), p.z()},
                              {{0, 46, 33}, {0, 30, 27}, {0, 14, 23}, {0, 2, 17}, {0, -8, 13}}, 1.6f, 3.0f);
    float behind = chain({std::max(q.x() - 30.0f, 0.0f), p.y(), p.z()},
                         {{0, -20, 13}, {0, -38, 14}, {0, -58, 24}}, 1.6f, 1.6f);
    behind = std::max(behind, 8.5f - std::hypot(p.x(), p.y() + 18));  // foramen magnum
    const float petrous = round_cone(q, {38, -6, 15}, {16, 6, 17}, 7, 4);
    float maxilla = ellipsoid(q, {12, 35, 7}, {7.5f, 9, 8});
    maxilla = smooth_union(
        maxilla,
        chain(q, {{15.5f, 20, -2}, {15, 29, -2.5f}, {12.5f, 37, -3}, {7.5f, 43.5f, -3}, {0, 45.5f, -3}}, 2.6f,
              2.6f),
        3);
    const float zygoma = chain(q, {{18, 36, 10}, {27, 32, 13}, {34, 18, 13}, {37, 6, 14}}, 2.6f, 1.6f);
    const float nasal = round_cone(q, {2, 46, 33}, {2.5f, 51, 22}, 1.2f, 1.0f);
    const float brow = chain(q, {{5, 46, 30}, {14, 44, 33}, {26, 36, 30}, {30, 31, 20}}, 2, 2);
    return smooth_union(std::min({vault, floor, behind, petrous, hard_palate(p), zygoma, nasal, brow}),
                        maxilla, 1);
}

float mandible_field(const Vec3f& in_jaw) {
    const Vec3f q = mirrored(in_jaw);
    float bone = chain(q,
                       {{33.5f, 2, 12},
                        {31.5f, 6, -2},
                        {29.5f, 9, -13},
                        {24, 21, -18},
                        {14, 34, -21.5f},
                        {0, 41.5f, -22.5f}},
                       2.2f, 3.2f);
    bone = smooth_union(
        bone,
        chain(q, {{28, 14, -11}, {22, 24, -14}, {14, 33, -16}, {7, 39.5f, -17}, {0, 41.8f, -17}}, 2.4f, 2.4f),
        3);
    bone = smooth_union(
        bone,
        chain(q,
              {{15, 20, -9.5f}, {14.5f, 28, -9.5f}, {12, 35.5f, -9.5f}, {7, 41.5f, -9.5f}, {0, 43.5f, -9.5f}},
              2.2f, 2.2f),
        2.5f);
    return smooth_union(bone, round_cone(q, {31, 7, -4}, {31, 13, 8}, 2.0f, 1.4f), 3);
}

float spine_field(const Vec3f& p) {
    const Vec3f q = mirrored(p);
    float bone = 1e3f;
    for (int i = 0; i < 12; ++i) {
        const auto n = static_cast<float>(i);
        const float z = 9 - n * 8.4f - 0.036f * n * n;
        if (std::fabs(p.z() - z) > 14) {
            continue;
        }
        const float y = -10.5f - 1.0f * n - 0.03f * n * n;
        const float body = i == 0 ? 1e3f : ellipsoid(p, {0, y, z}, {6.2f, 3.9f, i == 1 ? 3.6f : 2.5f});
        const float arch = chain(
            q,
            {{5.5f, y - 1.5f, z}, {8.5f, y - 6, z - 0.5f}, {6.5f, y - 11.5f, z - 1}, {0, y - 15.5f, z - 2}},
            1.6f, 1.2f);
        const float ring =
            i == 0 ? chain(q, {{8.5f, y - 4, z}, {5, y + 1.5f, z}, {0, y + 3, z}}, 1.5f, 1.3f) : 1e3f;
        const float process = round_cone(q, {6, y - 1, z}, {12, y - 2, z}, 1.4f, 1.2f);
        bone = std::min({bone, smooth_union(body, arch, 1), ring, process});
    }
    return bone;
}

float hyoid_field(const Vec3f& p) {
    // Body below the tongue's root, anterior to the epiglottis; greater horns beside the pharynx.
    const Vec3f q = mirrored(p);
    return smooth_union(
        chain(q, {{0, 16.5f, -33.5f}, {6.5f, 14.5f, -33.0f}}, 1.5f, 1.4f),
        chain(q, {{6.5f, 14.5f, -33.0f}, {10.5f, 9.5f, -31.5f}, {12.0f, 3.5f, -30.0f}}, 1.1f, 0.9f), 1.0f);
}

}  // namespace eti::patient
