// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/visible/visible_head.hpp"

#include <algorithm>
#include <cmath>

#include "server/patient/newborn/body/body_shape.hpp"
#include "server/patient/newborn/bones.hpp"
#include "server/patient/newborn/head.hpp"
#include "server/patient/newborn/jaw.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

constexpr float cloth_from = -86.0f;   // upper edge, at the chest
constexpr float cover = 0.2f;          // of skin over the physical outline
constexpr float nappy_from = -178.0f;  // upper edge, below the navel

/// Profile of a crease of this half width: 1 in the middle, 0 beside it.
float crease(float off, float half_width) {
    return std::exp(-off * off / (half_width * half_width));
}

/// Depth of the skin at the closed eyes: the line between the lids, the fold above it.
float lid_lines(const Vec3f& q) {
    const float side = (q.x() - 17.5f) / 7.5f;
    const float line = 19.8f + 1.6f * side * side;
    const float along = 1.0f - smoothstep(0.8f, 1.05f, std::fabs(side));
    const float fold = 26.5f - 1.6f * side * side;
    return along * (0.9f * crease(q.z() - line, 0.45f) + 0.35f * crease(q.z() - fold, 0.7f)) *
           smoothstep(30.0f, 36.0f, q.y());
}

float nose(const Vec3f& p, const Vec3f& q) {
    const float bridge = round_cone(p, {0, 48, 26}, {0, 58.2f, 9.8f}, 3.2f, 4.6f);
    const float wing = ellipsoid(q, {5.4f, 53.8f, 7.8f}, {2.9f, 3.8f, 3.0f});
    const float columella = round_cone(p, {0, 58.0f, 7.5f}, {0, 54.0f, 4.6f}, 1.5f, 1.6f);
    const float nostril = round_cone(q, {2.9f, 55.6f, 3.2f}, {3.0f, 53.5f, 9}, 1.6f, 1.2f);
    return smooth_difference(smooth_union(smooth_union(bridge, wing, 1.6f), columella, 1.5f), nostril, 0.7f);
}

/// Helix, antihelix and lobe around the concha.
float ear(const Vec3f& q) {
    // In the auricle's own plane, which is angled backwards from the head.
    const Vec3f o = q - Vec3f(39.5f, -17.0f, 9.0f);
    constexpr float off = 0.42f;  // [rad]
    const Vec3f a(std::cos(off) * o.x() + std::sin(off) * o.y(),
                  -std::sin(off) * o.x() + std::cos(off) * o.y(), o.z());
    const float lean = a.y() + 0.15f * a.z();
    const float leaf = ellipsoid({a.x(), lean, a.z()}, {0, 0, 0}, {1.7f, 8.2f, 14.0f});
    const float around = std::hypot(lean / 7.6f, (a.z() - 0.8f) / 12.6f);
    const float rim =
        std::hypot((around - 1.0f) * 7.6f, a.x() - 0.9f) - (1.3f + 0.5f * smoothstep(4, -12, a.z()));
    // The helix ends anteriorly, above the ear canal.
    const float helix = std::max(rim, lean - 5.6f - 0.4f * std::max(a.z(), 0.0f));
    const float inner = std::hypot((lean + 1.2f) / 4.2f, (a.z() - 1.5f) / 7.4f);
    const float antihelix = std::max(std::hypot((inner - 1.0f) * 4.2f, a.x() - 0.6f) - 1.0f, lean - 1.6f);
    const float concha = ellipsoid({a.x(), lean, a.z()}, {2.0f, 0.8f, -0.6f}, {2.6f, 4.0f, 5.6f});
    const float tragus = ellipsoid({a.x(), lean, a.z()}, {0.8f, 6.0f, -1.8f}, {1.5f, 1.6f, 2.4f});
    const float lobe = ellipsoid({a.x(), lean, a.z()}, {0.5f, 1.8f, -11.8f}, {1.7f, 3.4f, 3.6f});
    const float auricle =
        smooth_union(smooth_union(smooth_union(leaf, helix, 1.2f), antihelix, 1.0f), lobe, 1.5f);
    return smooth_union(smooth_difference(auricle, concha, 0.8f), tragus, 1.0f);
}

/// Neck, shoulders and chest.
float trunk(const Vec3f& p, const Vec3f& q) {
    const float neck = duct(p, {{-4, 0, 31, 29}, {-9, -38, 30, 29}, {-13, -62, 33, 30}, {-16, -80, 38, 31}});
    // Folds of a short neck.
    const float folds =
        smoothstep(-4.0f, 10.0f, p.y()) *
        (0.9f * crease(p.z() + 44.0f + 0.12f * p.y(), 1.3f) + 0.6f * crease(p.z() + 54.0f, 1.2f));
    const float shoulders = round_cone(q, {0, -20, -75}, {42, -24, -84}, 19, 16);
    const float across = p.x() / 54.0f, deep = (p.y() + 18.5f) / 38.5f;
    const float rounded = std::sqrt(std::sqrt(std::pow(across, 4.0f) + std::pow(deep, 4.0f)));
    const float chest = smooth_intersection((rounded - 1.0f) * 38.5f, p.z() + 66.0f, 24.0f);
    return smooth_union(neck + folds, smooth_union(shoulders, chest, 14.0f), 12.0f);
}

}  // namespace

float visible_cloth(const Vec3f& p) {
    if (p.z() > cloth_from + 14.0f) {
        return p.z() - cloth_from;
    }
    const float body = trunk(p, mirrored(p));
    const float hem =
        cloth_from + 6.0f * p.x() * p.x() / (54.0f * 54.0f) + 2.0f * std::sin(0.11f * p.x() + 0.6f);
    const float pleats = 0.7f * std::sin(0.21f * p.x() + 0.12f * p.z() + 1.5f * std::sin(0.05f * p.z())) +
                         0.5f * std::sin(0.33f * p.y() - 0.17f * p.z());
    const float outside =
        body - 2.6f - pleats * smoothstep(hem, hem - 14.0f, p.z()) - 0.8f * crease(p.z() - hem + 1.6f, 1.4f);
    const float wrap =
        smooth_intersection(smooth_intersection(outside, trunk_end - p.z(), 8.0f), p.z() - hem, 1.5f);
    // Overlaps the body, so that no gap is visible.
    return std::max(wrap, -std::max(body + 3.0f, trunk_end + 8.0f - p.z()));
}

float visible_skin(const Vec3f& point, const Vec3f& in_jaw, float cranium_size) {
    const Vec3f p = to_standard_cranium(point, cranium_size);
    const Vec3f q = mirrored(p);
    const float cranium = ellipsoid(p, {0, -18, 47}, {47, 58, 46});
    const float temples = ellipsoid(q, {20, -12, 15}, {18.5f, 24, 20});
    const float socket = ellipsoid(q, {17, 49, 24}, {12, 8, 8});
    const float face = smooth_difference(ellipsoid(p, {0, 20, 12}, {36, 34, 36}), socket, 10);
    const float lids = ellipsoid(q, {17.5f, 36.5f, 22.5f}, {10.5f, 8.5f, 8.0f});
    const float cheek = ellipsoid(q, {20, 25, -6}, {17, 19, 18});
    const float upper_lip = ellipsoid(p, {0, 47, -1.5f}, {16, 9.5f, 7.5f});
    float head = smooth_union(smooth_union(smooth_union(cranium, temples, 16), face, 14), lids, 6);
    head = smooth_union(head, smooth_union(cheek, smooth_union(upper_lip, nose(p, q), 2.5f), 8), 14);
    // The philtrum, and the swelling edge of the upper lip below it.
    const float front = smoothstep(46.0f, 50.0f, p.y());
    head +=
        front * 0.6f * crease(p.x(), 1.6f) * smoothstep(-5.0f, -3.0f, p.z()) * smoothstep(4.0f, 1.0f, p.z());
    const float mouth = 1.0f - smoothstep(9.0f, 14.0f, std::fabs(p.x()));
    head -= front * mouth * 0.7f * crease(p.z() + 4.6f + 0.012f * p.x() * p.x(), 1.7f);
    head += lid_lines(q);
    float chin = smooth_union(ellipsoid(in_jaw, {0, 40, -21}, {12, 10, 11}),
                              smooth_union(ellipsoid(in_jaw, {0, 26, -19}, {27, 24, 14}),
                                           ellipsoid(in_jaw, {0, 47.5f, -11.5f}, {13, 7.5f, 6}), 5),
                              8);
    chin -= front * mouth * 0.6f * crease(in_jaw.z() + 9.2f, 1.9f);
    // The fold under the lower lip.
    chin += smoothstep(44.0f, 48.0f, in_jaw.y()) * 0.8f * crease(in_jaw.z() + 15.5f, 2.0f) * mouth;
    head = smooth_union(smooth_union(head, ear(q), 1.5f), chin, 7);
    return smooth_intersection(smooth_union(head, trunk(p, q), 12), trunk_end + 5.0f - p.z(), 6.0f);
}

namespace {

/// Rounded lids closed over the eyes of a body, whose data have pits at the corners.
float closed_lids(const Vec3f& q) {
    return smooth_union(ellipsoid(q, {19.0f, 33.0f, 25.2f}, {11.5f, 9.6f, 7.2f}),
                        ellipsoid(q, {11.5f, 40.4f, 25.2f}, {3.6f, 2.6f, 3.0f}), 2.0f);
}

/// Depth of the line between them, and of the fold above.
float lid_folds(const Vec3f& q) {
    const float side = (q.x() - 19.2f) / 9.3f;
    const float along = 1.0f - smoothstep(0.75f, 1.1f, std::fabs(side));
    const float line = 24.3f + 1.3f * side * side, fold = 30.3f - 2.2f * side * side;
    return along * smoothstep(26.0f, 32.0f, q.y()) *
           (0.8f * crease(q.z() - line, 0.7f) + 0.5f * crease(q.z() - fold, 1.1f));
}

/// Place in a standard face of a place in a standard cranium. Below a cranium that is usually large for its
/// face, as before 28 weeks, the middle of the face comes forward too, so that the brow does not overhang the
/// eyes. The face does not follow a cranium that grows beyond its usual size.
Vec3f to_standard_face(Vec3f q, float usual_size) {
    if (usual_size <= 1.0f) {
        return q;
    }
    const Vec3f p = to_scaled_cranium(q, usual_size);
    const float wide = 1.0f + (usual_size - 1.0f) * smoothstep(2.0f, 50.0f, p.z());
    const float front = smoothstep(10.0f, 34.0f, p.y()) * (1.0f - smoothstep(24.0f, 36.0f, std::fabs(p.x())));
    const float y = cranium_axis_y + (p.y() - cranium_axis_y) / wide;
    q.y() += front * std::min(y - q.y(), 0.0f);
    return q;
}

}  // namespace

float visible_skin(const BodyShape& body, const Vec3f& point, const Vec3f& in_jaw, float cranium_size,
                   float usual_cranium_size, float rest_jaw_deg) {
    const float head = smoothstep(-62.0f, -44.0f, point.z());
    const Vec3f closed = point + head * jaw_share(point, rest_jaw_deg) * (in_jaw - point);
    // The physical outline contains the shell, which the skin must cover beneath the chin and at the nose;
    // the rest of the face has its own shape.
    const float to_nose = round_cone(point, {0, 53, 22}, {0, 59, 11}, 3.0f, 4.0f);
    // A short neck's crease, which would overstretch as the head is raised, is filled by 2 mm.
    const float crease_fill =
        2.0f * smoothstep(-26.0f, -33.0f, point.z()) * smoothstep(-60.0f, -48.0f, point.z());
    const float within =
        cover - crease_fill + 8.0f * smoothstep(-9.0f, -2.0f, point.z()) * smoothstep(0.5f, 4.0f, to_nose);
    // A wide fillet between chin and neck, whose crease opens as the head is raised.
    const float fillet = 4.0f + 10.0f * (1.0f - smoothstep(-22.0f, -12.0f, point.z()));
    const Vec3f usual = to_standard_face(to_standard_cranium(closed, cranium_size), usual_cranium_size);
    const Vec3f q = mirrored(usual);
    const float face = smooth_union(body.distance(usual), closed_lids(q), 2.5f) + lid_folds(q);
    const float skin = smooth_union(face, skin_field(point, in_jaw, cranium_size) + within, fillet);
    constexpr float over_bone = 1.2f, farthest = 5.0f;
    if (skin < -over_bone || skin > farthest) {
        return skin;
    }
    return smooth_union(skin, std::min(skull_field(point, cranium_size), mandible_field(in_jaw)) - over_bone,
                        2.0f);
}

float visible_nappy(float skin, const Vec3f& p) {
    // From the navel to the groins; it lies 3 mm off the skin, with soft folds along the thighs.
    const float waist = p.z() - nappy_from - 4.0f * smoothstep(-20.0f, 60.0f, p.y());
    const Vec3f q = mirrored(p);
    const float groin = (q - Vec3f(46.0f, 0.0f, -222.0f)).dot(Vec3f(0.80f, 0.25f, -0.2f).normalized()) - 6.0f;
    const float pleats = 0.5f * std::sin(0.5f * p.x() + 0.2f * p.z()) + 0.3f * std::sin(0.45f * p.y());
    const float outside = skin - 3.0f - pleats - 0.9f * crease(waist + 2.0f, 2.0f);
    const float region = smooth_intersection(smooth_intersection(waist, groin, 6.0f), q.x() - 74.0f, 4.0f);
    return smooth_intersection(smooth_intersection(outside, region, 2.0f), -(skin + 3.0f), 1.0f);
}

bool on_lip(const Vec3f& half, float mouth_width) {
    const float side = half.x() / (13.5f * mouth_width);
    if (half.y() < 42.0f || std::fabs(side) > 1.0f) {
        return false;
    }
    const float above = half.z() + 6.3f;
    const float taper = std::sqrt(1.0f - side * side);
    // Cupid's bow.
    const float bow = 1.0f - 0.22f * crease(half.x(), 1.4f) - 0.1f * std::fabs(side);
    return above < 4.3f * taper * bow && above > -4.6f * taper;
}

}  // namespace eti::patient
