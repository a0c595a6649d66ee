// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/anatomy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/mesh/closest_point.hpp"

namespace eti::patient {

VisibleFields Anatomy::visible_fields(const Vec3f& point) const {
    const Fields f = fields(point);
    const float tongue = std::max(f.tongue, -f.sublingual);
    // Leaves no visible gap between tongue and floor of the mouth.
    const float overlap = 0.5f * scale();
    return {body_field(f, tongue, overlap), tongue, f.epiglottis};
}

Tissue Anatomy::lining(const Vec3f& point) const {
    const Fields f = fields(point);
    const float margin = 0.6f * scale();
    const Vec3f model = to_model(point);
    if (f.upper_gum < margin) {
        return Tissue::upper_gum;
    }
    if (f.lower_gum < margin) {
        return Tissue::lower_gum;
    }
    if (f.palate < margin) {
        return Tissue::palate;
    }
    if (f.larynx < margin) {
        return model.z() < -46.0f ? Tissue::trachea : Tissue::larynx;
    }
    if (model.z() < -41.0f && f.cavity < margin && f.skin < -3.0f * margin) {
        return Tissue::oesophagus;
    }
    return Tissue::soft;
}

Tissue Anatomy::visible_tissue(const Vec3f& point) const {
    const Tissue lined = lining(point);
    if (lined != Tissue::larynx) {
        return lined;
    }
    const auto points = landmarks();
    const Vec3f off = offset_from_segment(at(points, Landmark::glottis_anterior),
                                          at(points, Landmark::glottis_posterior), point);
    return off.norm() < 2.0f * scale() ? Tissue::vocal_cord : Tissue::larynx;
}

std::vector<Vec3f> Anatomy::glottis_contour() const {
    // In the glottis's plane, by bisection on the field of what covers it.
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
            (visible_fields(centre + middle * direction).body > 0.0f ? inside : outside) = middle;
        }
        contour.push_back(centre + inside * direction);
    }
    return contour;
}

}  // namespace eti::patient
