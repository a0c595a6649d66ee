// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/newborn.hpp"

#include "common/math/units.hpp"
#include "server/patient/newborn/larynx.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::anatomy {

namespace {

// Model coordinates: x left, y anterior, z superior; millimetres of the 3.5 kg term newborn.
const Vec3f jaw_joint(0.0f, 2.0f, 13.0f);
// Between skull and atlas, where most of the nodding happens.
const Vec3f neck_joint(0.0f, -12.0f, 2.0f);
const Vec3f gum_crest(0.0f, 45.5f, -6.9f);
// The mouth is sampled slightly open, so that the lips are apart; posture adds to this.
constexpr float parted_lips_deg = 4.0f;
constexpr float jaw_slide_per_deg = 0.12f;
// How far a tongue can be pressed into the floor of the mouth where nothing firm is nearer.
constexpr float soft_floor = 9.0f;

Vec3f turn_about_jaw(const Vec3f& p, float degrees) {
    const float c = std::cos(degrees * degree);
    const float s = std::sin(degrees * degree);
    const float a = p.y() - jaw_joint.y();
    const float z = p.z() - jaw_joint.z();
    return {p.x(), jaw_joint.y() + a * c - z * s - jaw_slide_per_deg * degrees,
            jaw_joint.z() + a * s + z * c};
}

Vec3f turn_back_about_jaw(Vec3f p, float degrees) {
    p.y() += jaw_slide_per_deg * degrees;
    const float c = std::cos(degrees * degree);
    const float s = std::sin(degrees * degree);
    const float a = p.y() - jaw_joint.y();
    const float z = p.z() - jaw_joint.z();
    return {p.x(), jaw_joint.y() + a * c + z * s, jaw_joint.z() - a * s + z * c};
}

// The cranium grows from this height upwards and about this axis; face and airway do not follow it.
constexpr float cranium_floor = 26.0f;
constexpr float cranium_axis_y = -18.0f;

/// What a cranium of `size` is wider by, at a height above its floor.
float cranium_width(float above, float size) {
    return 1.0f + (size - 1.0f) * smoothstep(0.0f, 22.0f, above);
}

/// From a head whose cranium is `size` times the usual one to the usual head.
Vec3f usual_cranium(const Vec3f& p, float size) {
    if (size == 1.0f || p.z() <= cranium_floor) {
        return p;
    }
    const float above = p.z() - cranium_floor;
    const float wide = cranium_width(above, size);
    return {p.x() / wide, cranium_axis_y + (p.y() - cranium_axis_y) / wide,
            p.z() - (1.0f - 1.0f / size) * above * above / (above + 12.0f)};
}

/// Back to the head whose cranium is of `size`.
Vec3f sized_cranium(const Vec3f& p, float size) {
    if (p.z() <= cranium_floor) {
        return p;
    }
    // The height above the floor solves above^2 / size + (12 - usual) above = 12 usual.
    const float usual = p.z() - cranium_floor;
    const float half = 0.5f * (12.0f - usual);
    const float above = size * (std::sqrt(half * half + 12.0f * usual / size) - half);
    const float wide = cranium_width(above, size);
    return {p.x() * wide, cranium_axis_y + (p.y() - cranium_axis_y) * wide, cranium_floor + above};
}

float skin_field(const Vec3f& point, const Vec3f& in_jaw, float cranium_size) {
    const Vec3f p = usual_cranium(point, cranium_size);
    const Vec3f q = mirrored(p);
    const float cranium = ellipsoid(p, {0, -18, 47}, {47, 58, 46});
    const float socket = ellipsoid(q, {17, 47, 24}, {11, 7, 8});
    const float face = smooth_difference(ellipsoid(p, {0, 20, 12}, {36, 34, 36}), socket, 8);
    const float lids = ellipsoid(q, {17, 38.5f, 23.5f}, {8.5f, 7.5f, 7});
    const float cheek = ellipsoid(q, {21, 27, -6}, {15, 17, 16});
    const float upper_lip = ellipsoid(p, {0, 47, -1.5f}, {16, 9.5f, 7.5f});
    const float nose = smooth_union(round_cone(p, {0, 48, 26}, {0, 58.5f, 10}, 3, 4.8f),
                                    round_cone(q, {4.6f, 54.5f, 8}, {3.8f, 53.5f, 8}, 3.3f, 3.3f), 3);
    const float nostril = round_cone(q, {2.8f, 56.5f, 2.5f}, {3.0f, 54, 9}, 1.5f, 1.2f);
    float head = smooth_union(smooth_union(cranium, face, 14), lids, 4);
    head = smooth_union(head, smooth_union(cheek, smooth_union(upper_lip, nose, 5), 6), 10);
    head = smooth_difference(head, nostril, 1);
    const float chin = smooth_union(ellipsoid(in_jaw, {0, 40, -21}, {12, 10, 11}),
                                    smooth_union(ellipsoid(in_jaw, {0, 26, -19}, {27, 24, 14}),
                                                 ellipsoid(in_jaw, {0, 47.5f, -11.5f}, {13, 7.5f, 6}), 5),
                                    8);
    const float neck = duct(p, {{-4, 0, 30, 28}, {-8, -40, 27, 27}, {-12, -75, 30, 28}, {-14, -110, 40, 30}});
    const float shoulders = ellipsoid(p, {0, -16, -104}, {78, 34, 34});
    const float ear = smooth_difference(ellipsoid(q, {47, -16, 14}, {3.5f, 9, 14}),
                                        ellipsoid(q, {51, -14, 14}, {3, 5.5f, 9}), 2);
    return smooth_union(smooth_union(smooth_union(head, ear, 3), chin, 7), smooth_union(neck, shoulders, 16),
                        14);
}

struct Gums {
    float upper, lower;
};

Gums gum_fields(const Vec3f& p, const Vec3f& in_jaw) {
    return {
        chain(mirrored(p),
              {{15.5f, 20, -2}, {15, 29, -2.5f}, {12.5f, 37, -3}, {7.5f, 43.5f, -3}, {0, 45.5f, -3}}, 3.9f,
              3.9f),
        chain(mirrored(in_jaw),
              {{15, 20, -9.5f}, {14.5f, 28, -9.5f}, {12, 35.5f, -9.5f}, {7, 41.5f, -9.5f}, {0, 43.5f, -9.5f}},
              3.7f, 3.7f)};
}

float oral_vault(const Vec3f& p) {
    return ellipsoid(p, {0, 27, -6}, {13.5f, 22, 9.5f});
}

float hard_palate(const Vec3f& p) {
    const float vault = oral_vault(p);
    const float plate = smooth_intersection(vault - 3.4f, -(vault - 1.2f), 0.5f);
    return smooth_intersection(plate, std::max(18.5f - p.y(), -0.5f - p.z()), 0.5f);
}

float soft_palate(const Vec3f& p) {
    const Vec3f flat(p.x() * 0.22f, p.y(), p.z());
    const float velum = std::max(
        chain(flat, {{0, 20, 4.6f}, {0, 14, 3.0f}, {0, 9.5f, -1.5f}, {0, 8.2f, -6}, {0, 8.4f, -8.5f}}, 2.4f,
              1.7f),
        std::fabs(p.x()) - 12.0f);
    return smooth_union(velum, round_cone(p, {0, 8.4f, -6.5f}, {0, 8.6f, -10.5f}, 1.9f, 1.5f), 1.5f);
}

// From here the tongue grows, and shrinks, to all sides.
const Vec3f tongue_centre(0, 18, -18);

float tongue_shape(const Vec3f& in_jaw, float scale) {
    const Vec3f t = tongue_centre + (in_jaw - tongue_centre) / scale;
    float shape = smooth_union(
        ellipsoid(t, {0, 23.5f, -12.5f}, {13.5f, 19, 13}),
        round_cone({t.x() * 0.55f, t.y(), t.z()}, {0, 28, -8.5f}, {0, 39.5f, -8.2f}, 7.0f, 3.6f), 6);
    shape = smooth_union(shape, ellipsoid(t, {0, 17.0f, -20.5f}, {11.5f, 8.2f, 11.5f}), 6) * scale;
    // Median sulcus.
    return shape + 0.9f * std::exp(-t.x() * t.x() / 4.0f) * smoothstep(-14, -4, t.z());
}

/// Between the tip's underside and the floor, from side to side but for the frenulum, which the tongue keeps.
/// The tip rests on gum and floor: one sees into this space where the tongue is lifted or cut.
float sublingual_space(const Vec3f& in_jaw) {
    const float space = ellipsoid(in_jaw, {0, 38.6f, -12.2f}, {9, 5, 1.8f});
    // It holds to the tongue well behind the tip and to the floor, not to the gum's ridge (what Hazelbaker's
    // tool scores as normal; Amir 2006, Int Breastfeed J 1:3). Thicker than in life: a thinner fold would
    // fall between the nodes of the surface's grid, 1 mm apart.
    const float frenulum =
        std::max(std::fabs(in_jaw.x()) - 0.9f, in_jaw.y() - (37.6f + 0.25f * (-12.2f - in_jaw.z())));
    return smooth_difference(space, frenulum, 0.6f);
}

struct Cavities {
    float air, larynx, cricoid;
};

/// Lumen of mouth, pharynx, larynx and gullet, and the solid larynx that it runs through.
Cavities cavity_fields(const Vec3f& p, const Vec3f& in_jaw, const Gums& gums, float rest_jaw_deg,
                       float mouth_width) {
    const Vec3f q = mirrored(p);
    const float gap = 2.0f * std::sin(rest_jaw_deg * degree / 2.0f) * 48.0f;
    // Pharynx from the nasopharynx to the hypopharynx.
    float air = duct(p, {{9, 6, 9, 6.5f}, {4.6f, -6, 10, 4.6f}, {5.0f, -20, 10, 5.0f}, {4.2f, -31, 9, 4.2f}});
    air = smooth_union(air, ellipsoid(p, {0, 9, 8}, {9, 7, 9}), 4);
    // Mouth: vault above, floor in the jaw's frame, lips and vestibule half-way between.
    const float upper = std::max(oral_vault(p), 8.0f - p.y());
    const float lower = ellipsoid(in_jaw, {0, 26, -8}, {13, 21, 10});
    const Vec3f half = turn_about_jaw(p, rest_jaw_deg * 0.5f);
    float middle = ellipsoid(half, {0, 28, -7}, {17, 24, 6.5f + gap * 0.33f});
    const float slit = std::max(gap * 0.36f, 0.4f);
    const float corner = 12.0f * mouth_width;
    const float rima = std::max((std::sqrt(half.x() * half.x() / (corner * corner) +
                                           (half.z() + 6.3f) * (half.z() + 6.3f) / (slit * slit)) -
                                 1.0f) *
                                    std::min(corner, slit),
                                36.0f - half.y());
    middle = smooth_union(middle, rima, 2.5f);
    const float vestibule =
        chain({q.x(), half.y(), half.z()},
              {{19.5f, 24, -6}, {18.5f, 33, -6}, {14.5f, 42, -6}, {8, 48.5f, -6}, {0, 50.3f, -6}},
              0.7f + gap * 0.02f, 0.7f + gap * 0.05f);
    middle = smooth_union(middle, vestibule, 1);
    float mouth = smooth_union(smooth_union(upper, lower, 3), middle, 3);
    mouth = smooth_union(mouth, ellipsoid(p, {0, 10, -12}, {11, 8, 8}), 4);  // fauces
    air = smooth_union(air, mouth, 2);
    // Vallecula, space before the epiglottis, piriform recesses, hypopharynx, oesophagus.
    air = smooth_union(air, ellipsoid(p, {0, 8.6f, -24.5f}, {7.5f, 3.6f, 6}), 1.5f);
    air = smooth_union(air, ellipsoid(q, {6.3f, 2.6f, -32.5f}, {2.6f, 3.0f, 6.5f}), 1.5f);
    air = smooth_union(air, duct(p, {{2.0f, -28, 8.5f, 2.2f}, {-0.6f, -35, 7, 1.3f}, {-2.4f, -42, 4, 1.1f}}),
                       1);
    air = smooth_union(air,
                       duct(p, {{-2.6f, -41, 3.4f, 1.4f},
                                {-4.9f, -50, 3.2f, 1.6f},
                                {-8.6f, -72, 3.2f, 1.6f},
                                {-12.0f, -96, 3.2f, 1.6f}}),
                       0.5f);
    const float larynx = laryngeal_solid(p);
    const float organs = std::min({hard_palate(p), soft_palate(p), gums.upper, gums.lower, larynx});
    air = smooth_difference(air, organs, 0.5f);
    const LaryngealFields fields = laryngeal_fields(p, larynx);
    return {smooth_union(air, fields.lumen, 0.5f), fields.wall, fields.cricoid};
}

float skull_field(const Vec3f& point, float cranium_size) {
    const Vec3f p = usual_cranium(point, cranium_size);
    const Vec3f q = mirrored(p);
    const float cranium = ellipsoid(p, {0, -18, 47}, {47, 58, 46});
    float vault = std::max(cranium + 3.0f, -(cranium + 5.6f));
    const float base =
        p.y() > -20 ? 20 + (p.y() + 20) * 0.28f : 14 + std::pow((-20 - p.y()) / 38.0f, 2.0f) * 16;
    vault = std::max(vault, base - 4 - p.z());
    if (p.z() > 70) {  // anterior fontanelle
        vault = std::max(vault, 11.0f - std::fabs(p.x()) - std::fabs(p.y() - 14) * 0.8f);
    }
    const float floor = chain({std::max(q.x() - 18.0f, 0.0f), p.y(), p.z()},
                              {{0, 46, 33}, {0, 30, 27}, {0, 14, 23}, {0, 2, 17}, {0, -8, 13}}, 1.6f, 3.0f);
    float behind = chain({std::max(q.x() - 30.0f, 0.0f), p.y(), p.z()},
                         {{0, -20, 13}, {0, -38, 14}, {0, -58, 24}}, 1.6f, 1.6f);
    behind = std::max(behind, 8.5f - std::hypot(p.x(), p.y() + 18));  // foramen magnum
    const float petrous = round_cone(q, {38, -6, 15}, {16, 6, 17}, 7, 4);
    float maxilla = ellipsoid(q, {12, 35, 7}, {7.5f, 9, 8});
    maxilla = smooth_union(
        maxilla,
        chain(q, {{15.5f, 20, -2}, {15, 29, -2.5f}, {12.5f, 37, -3}, {7.5f, 43.5f, -3}, {0, 45.5f, -3}}, 2.6f,
              2.6f),
        3);
    const float zygoma = chain(q, {{18, 36, 10}, {27, 32, 13}, {34, 18, 13}, {37, 6, 14}}, 2.6f, 1.6f);
    const float nasal = round_cone(q, {2, 46, 33}, {2.5f, 51, 22}, 1.2f, 1.0f);
    const float brow = chain(q, {{5, 46, 30}, {14, 44, 33}, {26, 36, 30}, {30, 31, 20}}, 2, 2);
    return smooth_union(std::min({vault, floor, behind, petrous, hard_palate(p), zygoma, nasal, brow}),
                        maxilla, 1);
}

float mandible_field(const Vec3f& in_jaw) {
    const Vec3f q = mirrored(in_jaw);
    float bone = chain(q,
                       {{33.5f, 2, 12},
                        {31.5f, 6, -2},
                        {29.5f, 9, -13},
                        {24, 21, -18},
                        {14, 34, -21.5f},
                        {0, 41.5f, -22.5f}},
                       2.2f, 3.2f);
    bone = smooth_union(
        bone,
        chain(q, {{28, 14, -11}, {22, 24, -14}, {14, 33, -16}, {7, 39.5f, -17}, {0, 41.8f, -17}}, 2.4f, 2.4f),
        3);
    bone = smooth_union(
        bone,
        chain(q,
              {{15, 20, -9.5f}, {14.5f, 28, -9.5f}, {12, 35.5f, -9.5f}, {7, 41.5f, -9.5f}, {0, 43.5f, -9.5f}},
              2.2f, 2.2f),
        2.5f);
    return smooth_union(bone, round_cone(q, {31, 7, -4}, {31, 13, 8}, 2.0f, 1.4f), 3);
}

float spine_field(const Vec3f& p) {
    const Vec3f q = mirrored(p);
    float bone = 1e3f;
    for (int i = 0; i < 12; ++i) {
        const auto n = static_cast<float>(i);
        const float z = 9 - n * 8.4f - 0.036f * n * n;
        if (std::fabs(p.z() - z) > 14) {
            continue;
        }
        const float y = -10.5f - 1.0f * n - 0.03f * n * n;
        const float body = i == 0 ? 1e3f : ellipsoid(p, {0, y, z}, {6.2f, 3.9f, i == 1 ? 3.6f : 2.5f});
        const float arch = chain(
            q,
            {{5.5f, y - 1.5f, z}, {8.5f, y - 6, z - 0.5f}, {6.5f, y - 11.5f, z - 1}, {0, y - 15.5f, z - 2}},
            1.6f, 1.2f);
        const float ring =
            i == 0 ? chain(q, {{8.5f, y - 4, z}, {5, y + 1.5f, z}, {0, y + 3, z}}, 1.5f, 1.3f) : 1e3f;
        const float process = round_cone(q, {6, y - 1, z}, {12, y - 2, z}, 1.4f, 1.2f);
        bone = std::min({bone, smooth_union(body, arch, 1), ring, process});
    }
    return bone;
}

float hyoid_field(const Vec3f& p) {
    // Body below the tongue's root, before the epiglottis; greater horns beside the pharynx.
    const Vec3f q = mirrored(p);
    return smooth_union(
        chain(q, {{0, 16.5f, -33.5f}, {6.5f, 14.5f, -33.0f}}, 1.5f, 1.4f),
        chain(q, {{6.5f, 14.5f, -33.0f}, {10.5f, 9.5f, -31.5f}, {12.0f, 3.5f, -30.0f}}, 1.1f, 0.9f), 1.0f);
}

/// The cranium's size against that of an isometrically grown head.
float cranium_of(const NewbornShape& shape) {
    const float grown = usual_head_circumference(shape.gestational_age).mean /
                        usual_head_circumference(40.0f).mean / std::cbrt(shape.weight / 3.5f);
    return grown * shape.head_scale;
}

/// Where the larynx's displacement counts: from the tongue's root to half-way down the trachea, between
/// spine and chin.
float laryngeal_share(const Vec3f& p) {
    return (1.0f - smoothstep(-26.0f, -13.0f, p.z())) * smoothstep(-84.0f, -50.0f, p.z()) *
           smoothstep(-11.0f, -3.0f, p.y()) * (1.0f - smoothstep(14.0f, 30.0f, p.y())) *
           (1.0f - smoothstep(14.0f, 26.0f, std::fabs(p.x())));
}

}  // namespace

Newborn::Newborn(const NewbornShape& shape)
    : shape_(shape),
      // Isometric growth: lengths go with the cube root of weight.
      scale_(1e-3f * std::cbrt(shape.weight / 3.5f)),
      rest_jaw_deg_(parted_lips_deg + shape.jaw_opening / degree),
      cranium_(cranium_of(shape)),
      larynx_shift_(0.0f, 1e3f * shape.larynx_anterior, 1e3f * shape.larynx_superior) {}

Vec3f Newborn::own_place(const Vec3f& model) const {
    return model + laryngeal_share(model) * larynx_shift_;
}

Vec3f Newborn::usual_place(const Vec3f& model) const {
    if (larynx_shift_.isZero(0.0f)) {
        return model;
    }
    // The share changes by less than 1 over the shift's length, so this converges.
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
    // The tongue follows the jaw at its tip and stays with the hyoid at its root.
    const float follow = 0.95f * smoothstep(6, 34, model.y());
    Vec3f in_jaw = turn_about_jaw(model, rest_jaw_deg_ * follow);
    if (shape_.mandible_scale != 1.0f) {
        // A short jaw holds the tip back and pushes the root into the throat (glossoptosis).
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
    // Bone stays a millimetre clear of the lumen: mucosa covers it.
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
    // The upper neck bends; the chin reaches lower but belongs to the head.
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
            // Height below the surface half-way between the jaws, as an angle about the jaw joint: sharp
            // where the mouth parts the tissue, wide where the cheek stretches.
            const Vec3f half = turn_about_jaw(p, rest_jaw_deg_ * 0.5f);
            const float radius = std::hypot(p.y() - jaw_joint.y(), p.z() - jaw_joint.z());
            const float below = (-6.3f - half.z()) / std::max(radius, 1.0f);
            const float turned = std::atan2(jaw_joint.z() - p.z(), p.y() - jaw_joint.y());
            const float parted = smoothstep(28, 34, p.y()) * (1.0f - smoothstep(11, 15, std::fabs(p.x())));
            const float half_width = (14.0f + (0.5f - 14.0f) * parted) * degree;
            jaw = smoothstep(-half_width, half_width, below) *
                  (1.0f - smoothstep(56 * degree, 82 * degree, turned)) * smoothstep(-4, 8, p.y());
            // The mouth floor goes with the tongue that grows out of it.
            const float floor =
                (1.0f - smoothstep(1.0f, 8.0f, tongue_field(p))) * (1.0f - smoothstep(-14, -9, p.z()));
            jaw += floor * (0.95f * smoothstep(6, 34, p.y()) - jaw);
            break;
        }
    }
    return {1 - head, head * (1 - jaw), head * jaw};
}

Vec3f Newborn::head_growth(const Vec3f& point) const {
    // Over the range of head_scale, which the growth is not quite straight in.
    constexpr float most = 0.15f;
    const Vec3f usual = usual_cranium(to_model(point), cranium_);
    return (from_model(sized_cranium(usual, (1.0f + most) * cranium_)) -
            from_model(sized_cranium(usual, (1.0f - most) * cranium_))) /
           (2.0f * most);
}

float Newborn::shell_offset(const Vec3f& point, const Fields& fields) const {
    const Vec3f p = to_model(point);
    const float bony = std::min({fields.upper_gum, fields.lower_gum, fields.palate}) / scale_;
    float offset = 0.4f + 1.1f * smoothstep(0.0f, 2.0f, bony);
    // Lips are lifted aside.
    const float lips = smoothstep(45.5f, 49.0f, p.y()) * (1.0f - smoothstep(18.0f, 24.0f, std::fabs(p.x()))) *
                       smoothstep(-26.0f, -20.0f, p.z()) * (1.0f - smoothstep(2.0f, 8.0f, p.z()));
    offset += 5.0f * lips * smoothstep(0.5f, 2.0f, bony);
    // Floor of the mouth and the tissue before the tongue's root are as soft as the tongue that is pressed
    // into them: the shell keeps a tongue from mandible and skin, not from them.
    const Vec3f half = turn_about_jaw(p, rest_jaw_deg_ * 0.5f);
    const float depth = std::min(fields.cavity, fields.tongue) / scale_;
    const float firm = std::min({fields.mandible, fields.skull, fields.spine, fields.lower_gum}) / scale_;
    const float soft = std::min({soft_floor, depth - fields.skin / scale_ - 2.5f, depth + firm - 1.0f});
    const float floor = smoothstep(2.0f, 8.0f, p.y()) * (1.0f - smoothstep(38.0f, 43.0f, p.y())) *
                        (1.0f - smoothstep(-12.0f, -7.0f, half.z())) * smoothstep(-40.0f, -34.0f, p.z()) *
                        (1.0f - smoothstep(14.0f, 18.0f, fields.tongue / scale_));
    offset += floor * std::max(soft - offset, 0.0f);
    // The cords part for a tube; of trachea and cricoid, whose lamina reaches up behind them, mucosa alone
    // yields.
    const float laryngeal = 1.0f - smoothstep(0.0f, 1.5f, fields.larynx / scale_);
    const float cords = smoothstep(-43, -40, p.z()) * (1.0f - smoothstep(-35, -31, p.z()));
    const float ring = 1.0f - smoothstep(0.0f, 1.0f, fields.cricoid / scale_);
    offset += laryngeal * (0.7f + 0.9f * cords * (1.0f - ring) - offset);
    return offset * scale_;
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
    // Half-way between the lips, however far they are apart.
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
    // Patient frame: posterior is positive, so model maxima of y become minima.
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

}  // namespace eti::anatomy
