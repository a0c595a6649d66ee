// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/sizing_field.hpp"

#include <algorithm>

#include "common/math/units.hpp"
#include "common/mesh/closest_point.hpp"

namespace eti::patient {

namespace {

constexpr float growth = 0.25f;
// Multiple of the spacing: trunk and scalp are not viewed closely.
constexpr float farthest = 4.0f;

}  // namespace

SizingField::SizingField(const Anatomy& anatomy, float spacing)
    : anatomy_(anatomy),
      coarsest_(farthest * spacing * anatomy.scale() / millimetre),
      size_(anatomy.scale() / millimetre),
      spacing_(spacing / 1e-3f),
      whole_body_(anatomy.visible_detail(Vec3f::Zero()) < 1.0f) {
    const float size = size_;
    const auto points = anatomy.landmarks();
    const auto add = [&](const Vec3f& from, const Vec3f& to, float reach, float edge) {
        parts_.push_back({from, to, reach * size, edge * spacing * size});
    };
    const auto beside = [&](const Vec3f& p, float x, float y, float z) {
        return Vec3f(p + 1e-3f * size * Vec3f(x, y, z));
    };
    const Vec3f& tip = at(points, Landmark::epiglottis_tip);
    const Vec3f& glottis = at(points, Landmark::glottis);
    add(tip, beside(glottis, 0.0f, 0.0f, -2.0f), 6.5e-3f, 0.3f);
    // Free edges of the cords and of the vestibular folds above them.
    add(beside(glottis, 0.0f, 0.0f, 2.5f), beside(glottis, 0.0f, 0.0f, -1.0f), 3.2e-3f, 0.2f);
    add(at(points, Landmark::vallecula), at(points, Landmark::vallecula), 6e-3f, 0.4f);
    add(glottis, at(points, Landmark::carina), 4e-3f, 0.8f);
    const Vec3f& upper_lip = at(points, Landmark::upper_lip);
    const Vec3f& lower_lip = at(points, Landmark::lower_lip);
    for (const float side : {-1.0f, 1.0f}) {
        for (const Vec3f& lip : {upper_lip, lower_lip}) {
            add(lip, beside(lip, 13.0f * side, 5.0f, 0.0f), 3e-3f, 0.4f);
        }
        for (const Landmark gum : {Landmark::upper_gum, Landmark::lower_gum}) {
            const Vec3f middle = at(points, gum);
            const Vec3f corner = beside(middle, 11.0f * side, 7.0f, 0.0f);
            add(middle, corner, 2e-3f, 0.4f);
            add(corner, beside(middle, 15.0f * side, 25.0f, 0.0f), 2e-3f, 0.5f);
        }
    }
    // Facial features at the newborn's positions, in model coordinates: lids, nose, ears.
    const auto place = [&](float x, float y, float z) {
        const Vec3f& gum = at(points, Landmark::upper_gum);
        const Vec3f off = Vec3f(x, y, z) - anatomy.to_model(gum);
        return beside(gum, off.x(), -off.y(), off.z());
    };
    if (!whole_body_) {
        add(place(0.0f, 54.0f, 12.0f), place(0.0f, 57.0f, 5.0f), 6e-3f, 0.6f);
        for (const float side : {-1.0f, 1.0f}) {
            add(place(11.0f * side, 43.0f, 20.5f), place(24.0f * side, 40.0f, 20.5f), 3e-3f, 0.45f);
            add(place(39.0f * side, -18.0f, 0.0f), place(39.0f * side, -16.0f, 18.0f), 9e-3f, 0.9f);
        }
    }
    uvula_ = {place(-5.0f, 5.0f, -9.0f), place(5.0f, 5.0f, -9.0f), 4e-3f * size, 0.5f * spacing * size};
    add(upper_lip, place(0.0f, 0.0f, 0.0f), 40e-3f, 2.0f);
    hem_ = place(0.0f, -18.0f, -84.0f);
    down_ = (place(0.0f, -18.0f, -120.0f) - hem_).normalized();
    // The hem of the cloth.
    add(place(0.0f, -18.0f, -86.0f), place(0.0f, -18.0f, -100.0f), 55e-3f, 2.2f);
    // Interior of the mouth, and throat.
    add(at(points, Landmark::upper_gum), at(points, Landmark::tongue_dorsum), 8e-3f, 0.9f);
    add(at(points, Landmark::tongue_dorsum), tip, 9e-3f, 0.9f);
    add(tip, at(points, Landmark::oesophagus_inlet), 8e-3f, 0.7f);
}

float SizingField::edge(const Vec3f& point) const {
    float finest = std::min(coarsest_, spacing_ * anatomy_.visible_detail(point));
    for (const Part& part : parts_) {
        finest = std::min(finest, edge_at(part, point));
    }
    return finest;
}

float SizingField::body_edge(const Vec3f& point) const {
    return std::min(edge(point), edge_at(uvula_, point));
}

float SizingField::edge_at(const Part& part, const Vec3f& point) {
    const float off = std::max(offset_from_segment(part.from, part.to, point).norm() - part.reach, 0.0f);
    return part.edge + growth * off;
}

float SizingField::cloth_edge(const Vec3f& point) const {
    constexpr float hem_breadth = 9e-3f, end = 40e-3f, shortest_hem = 1.4e-3f, shortest_end = 1.9e-3f;
    constexpr float to_waist = 92e-3f, shortest_waist = 1.4e-3f, of_nappy = 3.0e-3f;
    const float below = below_hem(point), unit = spacing_ * size_;
    if (whole_body_) {
        const float off_waist = std::max(std::fabs(below - to_waist * size_) - hem_breadth * size_, 0.0f);
        return std::min(shortest_waist * unit + growth * off_waist, of_nappy * unit);
    }
    const float to_hem = std::max(std::fabs(below) - hem_breadth * size_, 0.0f);
    const float to_end = std::max(end * size_ - below, 0.0f);
    return std::min(
        {shortest_hem * unit + growth * to_hem, shortest_end * unit + growth * to_end, coarsest_});
}

}  // namespace eti::patient
