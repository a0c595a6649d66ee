// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/lip_retraction.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/smoothstep.hpp"

namespace eti {
namespace {

// A finger pad moves the upper lip this far [m] past the gum's crest.
constexpr float past_the_gum = 2e-3f;

}  // namespace

Vec3f LipRetraction::retract_lips(const Vec3f& point) const {
    const Vec3f q = axes * (point - origin);
    const float before = smoothstep(begins, complete, q.z());
    if (before == 0.0f) {
        return point;
    }
    // Upper and lower lip blend at the corners of the mouth; the blend is wider when the mouth is hardly
    // open.
    const float middle = 0.5f * (upper_edge + lower_edge);
    const float half = 0.5f * std::max({lower_edge - upper_edge, 0.5f * (upper_shift + lower_shift), 1e-6f});
    const float lower = smoothstep(middle - half, middle + half, q.y());
    const float shift = lower * lower_shift * (1.0f - smoothstep(lower_edge, lower_edge + gather, q.y())) -
                        (1.0f - lower) * upper_shift * smoothstep(upper_edge - gather, upper_edge, q.y());
    return point + before * std::exp(-q.x() * q.x() / breadth) * shift * axes.row(1).transpose();
}

bool LipRetraction::moves(const Vec3f& centre, float radius) const {
    return reach() > 0.0f && axes.row(2).dot(centre - origin) + radius > begins;
}

LipRetraction lip_retraction(const Vec3f& eye, const Landmarks& now) {
    LipRetraction lips;
    const Vec3f back = eye - at(now, Landmark::glottis);
    if (!(back.norm() > 1e-6f)) {
        return lips;
    }
    const Vec3f towards_eye = back.normalized();
    const Vec3f across = towards_eye.cross(Vec3f::UnitY());  // the patient's anterior is up
    const Vec3f right = across.norm() > 1e-4f ? across.normalized() : towards_eye.unitOrthogonal();
    lips.axes.row(0) = right.transpose();
    lips.axes.row(1) = towards_eye.cross(right).transpose();
    lips.axes.row(2) = towards_eye.transpose();
    lips.origin = eye + towards_eye.dot(at(now, Landmark::upper_gum) - eye) * towards_eye;
    const auto height = [&](Landmark which) { return lips.axes.row(1).dot(at(now, which) - lips.origin); };
    lips.upper_edge = height(Landmark::upper_lip);
    lips.lower_edge = height(Landmark::lower_lip);
    const auto bounded = [](float shift) { return std::clamp(shift, 0.0f, LipRetraction::most); };
    lips.upper_shift = bounded(lips.upper_edge - height(Landmark::upper_gum) + past_the_gum);
    lips.lower_shift = bounded(height(Landmark::lower_gum) - lips.lower_edge);
    return lips;
}

}  // namespace eti
