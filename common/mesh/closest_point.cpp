// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/closest_point.hpp"

namespace eti {

ClosestPoint closest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3f ab = b - a;
    const Vec3f ac = c - a;
    const Vec3f ap = p - a;
    const float d1 = ab.dot(ap);
    const float d2 = ac.dot(ap);
    if (d1 <= 0.0f && d2 <= 0.0f) {
        return {a, Feature::vertex, 0};
    }
    const Vec3f bp = p - b;
    const float d3 = ab.dot(bp);
    const float d4 = ac.dot(bp);
    if (d3 >= 0.0f && d4 <= d3) {
        return {b, Feature::vertex, 1};
    }
    const float area_c = d1 * d4 - d3 * d2;
    if (area_c <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
        return {a + d1 / (d1 - d3) * ab, Feature::edge, 0};
    }
    const Vec3f cp = p - c;
    const float d5 = ab.dot(cp);
    const float d6 = ac.dot(cp);
    if (d6 >= 0.0f && d5 <= d6) {
        return {c, Feature::vertex, 2};
    }
    const float area_b = d5 * d2 - d1 * d6;
    if (area_b <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
        return {a + d2 / (d2 - d6) * ac, Feature::edge, 2};
    }
    const float area_a = d3 * d6 - d5 * d4;
    if (area_a <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
        return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), Feature::edge, 1};
    }
    const float scale = 1.0f / (area_a + area_b + area_c);
    return {a + ab * (area_b * scale) + ac * (area_c * scale), Feature::face, 0, {area_a, area_b, area_c}};
}

std::array<float, 2> closest_on_segments(const Vec3f& p0, const Vec3f& p1, const Vec3f& q0, const Vec3f& q1) {
    const Vec3f d1 = p1 - p0;
    const Vec3f d2 = q1 - q0;
    const Vec3f r = p0 - q0;
    const float a = d1.squaredNorm();
    const float e = d2.squaredNorm();
    const float f = d2.dot(r);
    if (a == 0.0f) {
        return {0.0f, e > 0.0f ? std::clamp(f / e, 0.0f, 1.0f) : 0.0f};
    }
    const float c = d1.dot(r);
    if (e == 0.0f) {
        return {std::clamp(-c / a, 0.0f, 1.0f), 0.0f};
    }
    const float b = d1.dot(d2);
    const float denominator = a * e - b * b;
    float s = denominator > 1e-6f * a * e ? std::clamp((b * f - c * e) / denominator, 0.0f, 1.0f) : 0.0f;
    float t = (b * s + f) / e;
    if (t < 0.0f) {
        t = 0.0f;
        s = std::clamp(-c / a, 0.0f, 1.0f);
    } else if (t > 1.0f) {
        t = 1.0f;
        s = std::clamp((b - c) / a, 0.0f, 1.0f);
    }
    return {s, t};
}

}  // namespace eti
