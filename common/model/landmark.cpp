// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/landmark.hpp"

#include "common/model/thresholds.hpp"

namespace eti {

Vec3f best_eye(const Landmarks& points, float distance) {
    // The gum occludes what is behind it: the line passes a third of the way from upper to lower gum.
    const Vec3f& gum = at(points, Landmark::upper_gum);
    const Vec3f under = gum + (at(points, Landmark::lower_gum) - gum) / 3.0f;
    const Vec3f onward = (under - at(points, Landmark::glottis)).normalized();
    return under + distance * onward;
}

Vec3f best_eye(const Landmarks& points) {
    return best_eye(points, threshold::eye_distance.as_float());
}

}  // namespace eti
