// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/newborn.hpp"

#include "common/math/units.hpp"
#include "server/patient/newborn/bones.hpp"
#include "server/patient/newborn/head.hpp"
#include "server/patient/newborn/jaw.hpp"
#include "server/patient/newborn/larynx.hpp"
#include "server/patient/newborn/mouth.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

// Model coordinates: x left, y anterior, z superior; millimetres of the 3.5 kg term newborn. Between skull
// and atlas, where most of the flexion takes place.
const Vec3f neck_joint(0.0f, -12.0f, 2.0f);
const Vec3f gum_crest(0.0f, 45.5f, -6.9f);
// Maximum depth to which a tongue can be pressed into the floor of the mouth where nothing firm is nearer.
constexpr float soft_floor = 9.0f;
// Depth to which mucosa over bone yields.
constexpr float mucosa_over_bone = 0.4f;
// Distances from the lower gum at which bone starts to be solid to a tool, and is fully so. A real jaw yields
// to a blade on its ridge. This one does not, and the blade would act as a lever between both gums.
constexpr float held_from = 1.0f, fully_held_from = 3.0f;
// Larger than the overlap of tongue and bone.
constexpr float bone_clearance = 5.0f;

/// The cranium's size relative to an isometrically scaled head.
float cranium_of(const NewbornShape& shape) {
    const float grown = mean_head_circumference(shape.gestational_age).mean /
                        mean_head_circumference(40.0f).mean / std::cbrt(shape.weight / 3.5f);
    return grown * shape.head_scale;
}

/// Weight of the larynx's displacement: from the tongue's root to half-way down the trachea, between spine
/// and chin.
float laryngeal_share(const Vec3f& p) {
    return (1.0f - smoothstep(-26.0f, -13.0f, p.z())) * smoothstep(-84.0f, -50.0f, p.z()) *
           smoothstep(-11.0f, -3.0f, p.y()) * (1.0f - smoothstep(14.0f, 30.0f, p.y())) *
           (1.0f - smoothstep(14.0f, 26.0f, std::fabs(p.x())));
}

}  // namespace

Newborn::Newborn(const NewbornShape& shape)
    : shape_(shape),
      // Isometric growth: lengths scale with the cube root of weight.
      scale_(1e-3f * std::cbrt(shape.weight / 3.5f)),
      rest_jaw_deg_(parted_lips_deg + shape.jaw_opening / degree),
      cranium_(cranium_of(shape)),
      larynx_shift_(0.0f, 1e3f * shape.larynx_anterior, 1e3f * shape.larynx_superior),
      body_(BodyShape::is_available() ? std::make_shared<const BodyShape>(shape.gestational_age) : nullptr) {}

Vec3f Newborn::own_place(const Vec3f& model) const {
    return model + laryngeal_share(model) * larynx_shift_;
}

Vec3f Newborn::usual_place(const Vec3f& model) const {
    if (larynx_shift_.isZero(0.0f)) {
        return model;
    }
    // Fixed-point iteration; it converges because the share changes by less than 1 over the shift's length.
    Vec3f place = model - laryngeal_share(model) * larynx_shift_;
    for (int round = 0; round < 6; ++round) {
        place = model - laryngeal_share(place) * larynx_shift_;
    }
    return place;
}

Vec3f Newborn::to_jaw(const Vec3f& model) const {
    Vec3f closed = turn_about_jaw(model, rest_jaw_deg_);
    if (shape_.mandible_scale != 1.0f) {
        closed.y() = jaw_joint.y() + (closed.y() - jaw_joint.y()) / shape_.mandible_scale;
    }
    return closed;
}

Vec3f Newborn::from_jaw(const Vec3f& closed) const {
    Vec3f own = closed;
    if (shape_.mandible_scale != 1.0f) {
        own.y() = jaw_joint.y() + (own.y() - jaw_joint.y()) * shape_.mandible_scale;
    }
    return turn_back_about_jaw(own, rest_jaw_deg_);
}

Vec3f Newborn::to_tongue(const Vec3f& model) const {
    // The tongue follows the jaw at its tip, and the hyoid at its root.
    const float follow = 0.95f * smoothstep(6, 34, model.y());
    Vec3f in_jaw = turn_about_jaw(model, rest_jaw_deg_ * follow);
    if (shape_.mandible_scale != 1.0f) {
        // A short jaw retracts the tip and displaces the root into the throat (glossoptosis).
        const float longer = (in_jaw.y() - jaw_joint.y()) * (1.0f / shape_.mandible_scale - 1.0f);
        const float pushed = 0.25f * (1.0f - shape_.mandible_scale) * (gum_crest.y() - jaw_joint.y());
        in_jaw.y() += follow * longer + (1.0f - follow) * pushed;
    }
    return in_jaw;
}

float Newborn::tongue_field(const Vec3f& model) const {
    return tongue_shape(to_tongue(model), shape_.tongue_scale);
}

// On the surface above the middle of the tongue's body.
Vec3f Newborn::tongue_dorsum() const {
    Vec3f inside(0, tongue_centre.y() + shape_.tongue_scale * (24.0f - tongue_centre.y()), tongue_centre.z());
    Vec3f outside(0, inside.y(), 25.0f);
    for (int halvings = 0; halvings < 20; ++halvings) {
        const Vec3f middle = 0.5f * (inside + outside);
        (tongue_field(middle) < 0.0f ? inside : outside) = middle;
    }
    return outside;
}

Vec3f Newborn::to_model(const Vec3f& point) const {
    return Vec3f(point.x(), -point.y(), point.z()) / scale_ + gum_crest;
}

Vec3f Newborn::from_model(const Vec3f& point) const {
    const Vec3f q = (point - gum_crest) * scale_;
    return {q.x(), -q.y(), q.z()};
}

Fields Newborn::fields(const Vec3f& point) const {
    const Vec3f p = usual_place(to_model(point));
    const Vec3f in_jaw = to_jaw(p);
    Fields f;
    f.skin = skin_field(p, in_jaw, cranium_) * scale_;
    if (f.skin > 2e-3f) {
        return f;
    }
    const Gums gums = gum_fields(p, in_jaw);
    const Cavities cavities = cavity_fields(p, in_jaw, gums, rest_jaw_deg_, shape_.mouth_scale);
    f.cavity = cavities.air * scale_;
    f.larynx = cavities.larynx * scale_;
    f.cricoid = cavities.cricoid * scale_;
    const Vec3f in_tongue = to_tongue(p);
    f.tongue = tongue_shape(in_tongue, shape_.tongue_scale) * scale_;
    f.sublingual = sublingual_space(in_tongue) * scale_;
    f.epiglottis = epiglottis_field(p) * scale_;
    f.upper_gum = gums.upper * scale_;
    f.lower_gum = gums.lower * scale_;
    f.palate = std::min(hard_palate(p), soft_palate(p)) * scale_;
    // Bone stays a millimetre away from the lumen: mucosa covers it.
    f.skull = std::max(skull_field(p, cranium_), 1.0f - cavities.air) * scale_;
    f.mandible = std::max(mandible_field(in_jaw), 1.0f - cavities.air) * scale_;
    f.spine = std::max(spine_field(p), 1.0f - cavities.air) * scale_;
    f.hyoid = std::max(hyoid_field(p), 1.0f - cavities.air) * scale_;
    return f;
}

Skeleton Newborn::skeleton() const {
    return {from_model(neck_joint), from_model(jaw_joint), jaw_slide_per_deg * scale_ / degree};
}

BoneWeights Newborn::bone_weights(const Vec3f& point, Tissue tissue) const {
    const Vec3f p = to_model(point);
    // The upper neck bends; the chin extends lower but belongs to the head.
    const float head = smoothstep(-42, 0, p.z() + 0.8f * std::max(p.y() - 10.0f, 0.0f));
    float jaw = 0.0f;
    switch (tissue) {
        case Tissue::upper_gum:
        case Tissue::palate:
        case Tissue::skull:
            return {0, 1, 0};
        case Tissue::lower_gum:
        case Tissue::mandible:
            return {0, 0, 1};
        case Tissue::tongue:
            jaw = 0.95f * smoothstep(6, 34, p.y());
            break;
        default: {
            jaw = jaw_share(p, rest_jaw_deg_);
            // The floor of the mouth moves with the tongue attached to it.
            const float floor =
                (1.0f - smoothstep(1.0f, 8.0f, tongue_field(p))) * (1.0f - smoothstep(-14, -9, p.z()));
            jaw += floor * (0.95f * smoothstep(6, 34, p.y()) - jaw);
            break;
        }
    }
    return {1 - head, head * (1 - jaw), head * jaw};
}

Vec3f Newborn::head_growth(const Vec3f& point) const {
    // Difference over the range of head_scale, in which growth is slightly nonlinear.
    constexpr float most = 0.15f;
    const Vec3f usual = to_standard_cranium(to_model(point), cranium_);
    return (from_model(to_scaled_cranium(usual, (1.0f + most) * cranium_)) -
            from_model(to_scaled_cranium(usual, (1.0f - most) * cranium_))) /
           (2.0f * most);
}

float Newborn::shell_field(const Vec3f& point, const Fields& fields) const {
    const Vec3f p = to_model(point);
    // The tongue is attached to the mandible, and its field continues inside it: bone is solid to a tool
    // there, too.
    const float ridge = 1.0f - smoothstep(held_from, fully_held_from, fields.lower_gum / scale_);
    const float bone = fields.mandible + scale_ * bone_clearance * ridge;
    const float root = std::max(fields.tongue, bone);
    const float hollow = std::min(fields.cavity, std::max(fields.tongue, scale_ * mucosa_over_bone - bone));
    const float bony = std::min({fields.upper_gum, fields.lower_gum, fields.palate, root}) / scale_;
    float offset = mucosa_over_bone + 1.1f * smoothstep(0.0f, 2.0f, bony);
    // Lips are retracted.
    const float lips = smoothstep(45.5f, 49.0f, p.y()) * (1.0f - smoothstep(18.0f, 24.0f, std::fabs(p.x()))) *
                       smoothstep(-26.0f, -20.0f, p.z()) * (1.0f - smoothstep(2.0f, 8.0f, p.z()));
    offset += 5.0f * lips * smoothstep(0.5f, 2.0f, bony);
    // The floor of the mouth and the tissue anterior to the tongue's root are as soft as the tongue pressed
    // into them: the shell keeps a tongue out of mandible and skin, not out of them.
    const Vec3f half = turn_about_jaw(p, rest_jaw_deg_ * 0.5f);
    const float depth = hollow / scale_;
    const float firm = std::min({fields.mandible, fields.skull, fields.spine, fields.lower_gum}) / scale_;
    const float soft = std::min({soft_floor, depth - fields.skin / scale_ - 2.5f, depth + firm - 1.0f});
    const float floor = smoothstep(2.0f, 8.0f, p.y()) * (1.0f - smoothstep(38.0f, 43.0f, p.y())) *
                        (1.0f - smoothstep(-12.0f, -7.0f, half.z())) * smoothstep(-40.0f, -34.0f, p.z()) *
                        (1.0f - smoothstep(14.0f, 18.0f, fields.tongue / scale_));
    // The skin over them does not yield; otherwise nothing of the wall would remain.
    float skin_offset = (1.0f - floor) * offset;
    offset += floor * std::max(soft - offset, 0.0f);
    // The cords yield to a tube. Of trachea and cricoid, whose lamina extends up behind the cords, only
    // mucosa yields.
    const float laryngeal = 1.0f - smoothstep(0.0f, 1.5f, fields.larynx / scale_);
    const float cords = smoothstep(-43, -40, p.z()) * (1.0f - smoothstep(-35, -31, p.z()));
    const float ring = 1.0f - smoothstep(0.0f, 1.0f, fields.cricoid / scale_);
    const float in_larynx = 0.7f + 0.9f * cords * (1.0f - ring);
    offset += laryngeal * (in_larynx - offset);
    skin_offset += laryngeal * (in_larynx - skin_offset);
    return std::max(fields.skin + scale_ * skin_offset, scale_ * offset - hollow);
}

std::array<Vec3f, landmark_count> Newborn::landmarks() const {
    std::array<Vec3f, landmark_count> points{};
    const auto set = [&](Landmark which, const Vec3f& model) {
        points[static_cast<std::size_t>(which)] = from_model(own_place(model));
    };
    const auto opened = [&](const Vec3f& closed) { return from_jaw(closed); };
    set(Landmark::upper_gum, gum_crest);
    set(Landmark::lower_gum, opened({0, 43.5f, -5.8f}));
    set(Landmark::upper_lip, {0, 53.5f, -6.4f});
    set(Landmark::lower_lip, opened({0, 52.5f, -7.0f}));
    // Half-way between the lips at any opening.
    const Vec3f between_lips(0, 53.0f, -8.0f);
    const float wider_deg = rest_jaw_deg_ - parted_lips_deg;
    set(Landmark::mouth_opening,
        wider_deg > 0.0f ? turn_back_about_jaw(between_lips, 0.5f * wider_deg) : between_lips);
    const Vec3f usual_tip(0, 43.0f, -8.5f);
    set(Landmark::tongue_tip, opened(tongue_centre + shape_.tongue_scale * (usual_tip - tongue_centre)));
    set(Landmark::tongue_dorsum, tongue_dorsum());
    set(Landmark::vallecula, {0, 8.4f, -27.0f});
    set(Landmark::epiglottis_tip, {0, 3.2f, -20.0f});
    set(Landmark::epiglottis_base, {0, 9.4f, -31.0f});
    set(Landmark::glottis, {0, glottis_y, glottis_z});
    set(Landmark::glottis_anterior, {0, glottis_y + glottis_half_length, glottis_z + 0.2f});
    set(Landmark::glottis_posterior, {0, glottis_y - glottis_half_length, glottis_z - 0.2f});
    set(Landmark::trachea_mid, {0, 1.2f, -62.0f});
    set(Landmark::carina, carina);
    set(Landmark::oesophagus_inlet, {0, -2.3f, -40.0f});
    set(Landmark::oesophagus_mid, {0, -6.9f, -62.0f});
    return points;
}

std::array<Vec3f, 2> Newborn::bounds() const {
    // Patient frame: posterior is positive, so maxima of model y become minima.
    const float size = std::max(cranium_, 1.0f);
    const Vec3f a = from_model({-62 * size, 66, -98});
    const Vec3f b = from_model({62 * size, cranium_axis_y - 62 * size, cranium_floor + 72 * size});
    return {a.cwiseMin(b), a.cwiseMax(b)};
}

std::array<Vec3f, 2> Newborn::airway_bounds() const {
    const Vec3f a = from_model({-26, 62, -94});
    const Vec3f b = from_model({26, -18, 16});
    return {a.cwiseMin(b), a.cwiseMax(b)};
}

}  // namespace eti::patient
