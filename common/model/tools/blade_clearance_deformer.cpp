// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/blade_clearance_deformer.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/smoothstep.hpp"
#include "common/math/units.hpp"
#include "common/model/tools/blade_camera.hpp"

namespace eti {

namespace {

constexpr float lip = 0.8e-3f;  // [m], height of the tip's

}  // namespace

float BladePlate::width(float along) const {
    return wide + (narrow - wide) * smoothstep(0.3f * length, 0.8f * length, along);
}

float BladePlate::height(float along) const {
    return high + (low - high) * smoothstep(0.35f * length, 0.65f * length, along) +
           lip * smoothstep(length - 8e-3f, length, along);
}

float BladePlate::outline(float along) const {
    const float to_tip = std::clamp((length - along) / rounding, 0.0f, 1.0f);
    return 0.5f * width(along) * (tip_width + (1.0f - tip_width) * std::sqrt(to_tip * (2.0f - to_tip)));
}

BladePlate plate_of(const Laryngoscope& scope) {
    const bool small = scope.blade == Blade::miller_0;
    return {.length = scope.blade_length,
            .wide = (small ? 8.0f : 10.0f) * millimetre,
            .narrow = (small ? 6.0f : 7.0f) * millimetre,
            .high = scope.capsules[1].radius,
            .low = scope.capsules[2].radius,
            .crown = 1.2f * millimetre};
}

Eigen::AlignedBox3f BladeClearanceDeformer::where() const {
    const bool parts = aside > 0.0f;
    const float far = parts ? lips_fade : beside;
    const float widest =
        std::max({0.5f * std::max(plate.wide, plate.narrow) + std::max(gathers * edge_aside, tip_beside),
                  parts ? corner + gathers * aside : 0.0f, parts ? 3.0f * aside + spare - corner : 0.0f});
    const float lowest =
        std::min({plate.high - under, plate.low - under, lens.y() - gathers * most}) - 1.5f * far;
    const float highest = std::max(plate.high, plate.low) + lip + 1.5f * far;
    const float ahead = std::max(far, gathers * tip_past);
    return {Vec3f(-widest, lowest, heel), Vec3f(widest, highest, plate.length + ahead)};
}

bool BladeClearanceDeformer::moves(const Vec3f& centre, float radius) const {
    return where().squaredExteriorDistance(centre) <= radius * radius;
}

float BladeClearanceDeformer::reach(const Vec3f& centre, float radius) const {
    if (!moves(centre, radius)) {
        return 0.0f;
    }
    const bool at_lips = aside > 0.0f && centre.z() - radius < lips_end + lips_fade;
    const bool above = centre.y() - radius > std::max(plate.high, plate.low) + lip + beside;
    const bool at_tip = centre.z() + radius > plate.length - tip_begins;
    return (above ? 0.0f : most + edge_aside + (at_tip ? tip_past : 0.0f)) + (at_lips ? aside : 0.0f);
}

Vec3f BladeClearanceDeformer::operator()(const Vec3f& point) const {
    if (!where().contains(point)) {
        return point;
    }
    Vec3f p = point;
    const float along = smoothstep(heel, heel + beside, p.z());
    const float crown = plate.height(p.z());
    const float off = std::max({p.y() - crown, crown - under - p.y(), 0.0f});  // above or below
    float of_lips = 0.0f;
    if (aside > 0.0f) {
        of_lips = smoothstep(heel, heel + lips_fade, p.z()) *
                  (1.0f - smoothstep(lips_end, lips_end + lips_fade, p.z())) *
                  (1.0f - smoothstep(0.0f, lips_fade, p.z() - plate.length));
        const float out = side * p.x() - corner;
        p.x() += side * aside * of_lips * (1.0f - smoothstep(0.0f, 1.5f * lips_fade, off)) *
                 smoothstep(-3.0f * aside - 0.5f * spare, -0.5f * spare, out) *
                 (1.0f - smoothstep(0.0f, gathers * aside, out));
        of_lips *= std::min(aside / spare, 1.0f);
    }
    p.z() += (1.0f - of_lips) * shift_past_tip(p);
    p.y() += plate.height(p.z()) - crown;  // along the face
    const float past_tip = p.z() - plate.length;
    const float outline = plate.outline(std::min(p.z(), plate.length - before_tip));
    const float share = std::min(outline / edge_begins, 1.0f);
    const float out = (std::fabs(p.x()) - outline) / share;
    const float over = std::clamp((out + edge_begins) / (edge_begins - edge), 0.0f, 1.0f);
    p.x() += std::copysign((1.0f - of_lips) * along * (1.0f - smoothstep(0.0f, beside, past_tip)) *
                               (1.0f - smoothstep(0.0f, beside, off)) * share * edge_aside * over *
                               (1.0f - smoothstep(-edge, gathers * edge_aside, out)),
                           p.x());
    const Vec3f lifted = push_off_face(p);
    return p + (1.0f - of_lips) * along * (lifted - p);
}

float BladeClearanceDeformer::depth_behind_face(const Vec3f& p) const {
    const float half = 0.5f * plate.width(p.z());
    const float from_middle = std::min(std::fabs(p.x()) / half, 1.0f);
    return plate.height(p.z()) - plate.crown * 2.0f * half / plate.wide * from_middle * from_middle +
           clearance - p.y();
}

float BladeClearanceDeformer::shift_past_tip(const Vec3f& p) const {
    const float half = 0.5f * plate.width(p.z());
    const float in = depth_behind_face(p);
    const float out = p.z() - plate.length;
    return tip_past * smoothstep(tip_from, deepest, in) * (1.0f - smoothstep(tip_until, tip_ends, in)) *
           (1.0f - smoothstep(half, half + tip_beside, std::fabs(p.x()))) *
           smoothstep(-tip_begins, -tip, out) * (1.0f - smoothstep(-tip, gathers * tip_past, out));
}

Vec3f BladeClearanceDeformer::push_off_face(Vec3f p) const {
    const float half = 0.5f * plate.width(p.z());
    const float across = std::fabs(p.x());
    const float on_plate = (1.0f - smoothstep(half, half + beside, across)) *
                           (1.0f - smoothstep(plate.length, plate.length + beside, p.z()));
    const float in = depth_behind_face(p);
    if (in <= softness) {
        const float deeper = std::max(in + softness, 0.0f);
        p.y() += on_plate * deeper * deeper / (4.0f * softness);
        return p;
    }
    // Remaining depth: zero down to `deepest`, then increasing until it reaches the original depth, or the
    // depth below the lens.
    const float beyond = std::max(in - deepest, 0.0f);
    const float left =
        steepest * (beyond < easing ? beyond * beyond / (2.0f * easing) : beyond - 0.5f * easing);
    const float lens_depth = in + p.y() - lens.y() + lens_spare;
    const float from = deepest + 0.5f * easing + lens_depth / steepest;
    const float down = lens_depth - from;
    const float stays =
        in + down * (1.0f - smoothstep(from, from + gathers * down, in)) *
                 (1.0f - smoothstep(lens_wholly, lens_fade, std::hypot(p.x() - lens.x(), p.z() - lens.z())));
    const float met = std::max(easing - std::fabs(left - stays), 0.0f);
    p.y() += on_plate * (in - std::min(left, stays) + met * met / (4.0f * easing));
    return p;
}

PosedBladeClearanceDeformer blade_clearance_for(const Laryngoscope& scope, const RigidTransform& tool,
                                                const Landmarks& now) {
    // For an open mouth, whose corners are not landmarks.
    constexpr float corner_by_airway = 0.135f;
    PosedBladeClearanceDeformer placed{{.plate = plate_of(scope), .lens = blade_camera_position(scope)},
                                       tool};
    BladeClearanceDeformer& give_way = placed.give_way;
    const RigidTransform to_tool = tool.inverse();
    const Vec3f middle = to_tool * at(now, Landmark::mouth_opening);
    const Vec3f& gum = at(now, Landmark::upper_gum);
    give_way.lips_end = (to_tool * gum).z();
    give_way.side = middle.x() > 0.0f ? -1.0f : 1.0f;
    give_way.corner = corner_by_airway * (gum - at(now, Landmark::glottis)).norm() - std::fabs(middle.x());
    const float along = std::clamp(give_way.lips_end, BladeClearanceDeformer::heel, give_way.plate.length);
    const float aside = 0.5f * give_way.plate.width(along) + BladeClearanceDeformer::spare - give_way.corner;
    // A tool far from the mouth does not part the lips.
    const float half = 0.5f * give_way.plate.width(along);
    const float passes = 1.0f - smoothstep(2.0f * half, 4.0f * half, -give_way.corner);
    give_way.aside = passes * std::clamp(aside, 0.0f, BladeClearanceDeformer::max_corner_shift);
    return placed;
}

}  // namespace eti
