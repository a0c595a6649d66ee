// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/anatomy.hpp"

#include <cmath>
#include <numbers>

namespace eti::anatomy {

std::vector<Vec3f> Anatomy::glottis_contour() const {
    // In the glottis's plane, found on the field itself by bisection.
    constexpr int count = 24;
    const auto points = landmarks();
    const Vec3f centre = at(points, Landmark::glottis);
    std::vector<Vec3f> contour;
    for (int i = 0; i < count; ++i) {
        const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / count;
        const Vec3f direction = scale() * Vec3f(std::cos(angle), -std::sin(angle), 0.0f);
        float inside = 0.0f;
        float outside = 4.0f;
        for (int step = 0; step < 20; ++step) {
            const float middle = 0.5f * (inside + outside);
            (fields(centre + middle * direction).cavity < 0.0f ? inside : outside) = middle;
        }
        contour.push_back(centre + inside * direction);
    }
    return contour;
}

}  // namespace eti::anatomy
