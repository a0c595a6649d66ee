// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/airway_axes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace eti::view {
namespace {

constexpr float axis_reach = 0.05f;  // [m], drawn length to each side

float angle(const Vec3f& a, const Vec3f& b) {
    return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0f, 1.0f));
}

AirwayAxis axis(std::string_view name, const Vec3f& through, const Vec3f& direction) {
    const Vec3f along = axis_reach * direction.normalized();
    return {name, through - along, through + along};
}

}  // namespace

AirwayAxes airway_axes(const Landmarks& now, float head_elevation) {
    // At rest the palate lies along posterior, +y; the chin rises as the skull rotates about the left-right
    // axis.
    const Vec3f palate = Eigen::AngleAxisf(-head_elevation, Vec3f::UnitX()) * Vec3f::UnitY();
    const Vec3f throat = at(now, Landmark::oesophagus_mid) - at(now, Landmark::oesophagus_inlet);
    const Vec3f larynx = at(now, Landmark::trachea_mid) - at(now, Landmark::glottis);
    return {{axis("mouth", at(now, Landmark::mouth_opening), palate),
             axis("throat", at(now, Landmark::oesophagus_inlet), throat),
             axis("larynx", at(now, Landmark::glottis), larynx)},
            angle(palate, throat),
            angle(throat, larynx)};
}

}  // namespace eti::view
