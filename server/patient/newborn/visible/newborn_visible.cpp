// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/head.hpp"
#include "server/patient/newborn/jaw.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/newborn/shape.hpp"
#include "server/patient/newborn/visible/visible_head.hpp"
#include "server/patient/newborn/visible/visible_larynx.hpp"
#include "server/patient/newborn/visible/visible_mouth.hpp"

namespace eti::patient {

VisibleFields Newborn::visible_fields(const Vec3f& point) const {
    const Vec3f p = usual_place(to_model(point));
    const Vec3f in_jaw = to_jaw(p);
    VisibleFields seen;
    const float skin = visible_outline(p, in_jaw);
    seen.cloth = (body_ ? visible_nappy(skin, p) : visible_cloth(p)) * scale_;
    if (skin > 2.0f) {
        seen.body = skin * scale_;
        return seen;
    }
    const float tongue = visible_tongue(to_tongue(p), shape_.tongue_scale);
    const Gums gums = visible_gums(p, in_jaw);
    const float throat = smooth_union(throat_and_mouth(p, in_jaw, rest_jaw_deg_, shape_.mouth_scale),
                                      room_of_velum(p, tongue), 1.0f);
    const float organs = std::min({gums.upper, gums.lower, visible_laryngeal_solid(p)});
    const float air = smooth_union(
        smooth_difference(smooth_difference(throat, visible_palate(p, tongue), 0.8f), organs, 0.5f),
        visible_laryngeal_lumen(p), 0.3f);
    // Leaves no visible gap between tongue and floor of the mouth.
    constexpr float overlap = 0.5f;
    seen.body = std::max(skin, -std::min(air, tongue + overlap)) * scale_;
    seen.tongue = tongue * scale_;
    seen.epiglottis = visible_epiglottis(p) * scale_;
    return seen;
}

float Newborn::visible_outline(const Vec3f& p, const Vec3f& in_jaw) const {
    return body_ ? visible_skin(*body_, p, in_jaw, cranium_, cranium_ / shape_.head_scale, rest_jaw_deg_)
                 : visible_skin(p, in_jaw, cranium_);
}

float Newborn::visible_detail(const Vec3f& point) const {
    return body_ ? body_->detail(to_standard_cranium(to_model(point), cranium_)) * scale_
                 : Anatomy::visible_detail(point);
}

Tissue Newborn::visible_tissue(const Vec3f& point) const {
    const Vec3f p = usual_place(to_model(point));
    constexpr float near = 0.5f;
    if (visible_laryngeal_lumen(p) < near) {
        return on_vocal_cord(p) ? Tissue::vocal_cord : p.z() < -40.5f ? Tissue::trachea : Tissue::larynx;
    }
    const Tissue lined = lining(point);
    if (lined != Tissue::soft) {
        return lined;
    }
    // Farther down the arches are part of the pharyngeal wall, which moves with the neck, too.
    if (p.z() > -15.0f && visible_palate(p, visible_tongue(to_tongue(p), shape_.tongue_scale)) < near) {
        return Tissue::palate;
    }
    if (p.z() < -24.0f && visible_laryngeal_solid(p) < near) {
        return Tissue::larynx;
    }
    return visible_outline(p, to_jaw(p)) > -1.0f &&
                   on_lip(turn_about_jaw(p, 0.5f * rest_jaw_deg_), shape_.mouth_scale)
               ? Tissue::lip
               : Tissue::soft;
}

float Newborn::epiglottis_coupling(const Vec3f& point) const {
    const Vec3f p = usual_place(to_model(point));
    return plate_coupling(p, visible_epiglottis(p), visible_laryngeal_solid(p));
}

std::array<Vec3f, 2> Newborn::visible_bounds() const {
    const auto [low, high] = bounds();
    std::array<Vec3f, 2> box = {Vec3f(-68, 0, trunk_end), Vec3f(68, 0, trunk_end)};
    if (body_) {
        // The cranium's growth is within bounds().
        const Vec3f margin = Vec3f::Constant(6.0f);  // clothes
        box = {body_->bounds()[0] - margin, body_->bounds()[1] + margin};
    }
    const Vec3f a = from_model(box[0]);
    const Vec3f b = from_model(box[1]);
    return {low.cwiseMin(a.cwiseMin(b)), high.cwiseMax(a.cwiseMax(b))};
}

}  // namespace eti::patient
