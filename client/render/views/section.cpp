// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/section.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eti::render {

Section::Section(float offset, float turn, float tilt) {
    shift(offset);
    rotate(turn, tilt);
}

void Section::shift(float by) {
    offset_ = std::clamp(offset_ + by, -max_offset, max_offset);
}

void Section::rotate(float turn, float tilt) {
    turn_ = std::remainder(turn_ + turn, 2.0f * std::numbers::pi_v<float>);
    tilt_ = std::clamp(tilt_ + tilt, -max_tilt, max_tilt);
}

Mat3f Section::rotation() const {
    return (Eigen::AngleAxisf(turn_, Vec3f::UnitY()) * Eigen::AngleAxisf(tilt_, Vec3f::UnitZ()))
        .toRotationMatrix();
}

CutPlane Section::plane(const Landmarks& now) const {
    Vec3f middle = 0.4f * at(now, Landmark::mouth_opening) + 0.6f * at(now, Landmark::glottis);
    middle.x() = 0.0f;
    const Vec3f normal = rotation().col(0);
    return {middle + offset_ * normal, normal};
}

Vec3f Section::up() const {
    return -rotation().col(1);
}

}  // namespace eti::render
