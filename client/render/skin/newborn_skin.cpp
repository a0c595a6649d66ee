// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/newborn_skin.hpp"

#include <algorithm>
#include <cmath>

#include "client/render/skin/value_noise.hpp"
#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

const Vec3f upper_gum_model(0.0f, 45.5f, -6.9f);  // origin of the patient frame

// Term: pale pink on a background of vernix. 28 weeks: thin and gelatinous, so that blood shows through.
const Vec3f term_colour(0.91f, 0.71f, 0.63f);
const Vec3f preterm_colour(0.76f, 0.47f, 0.43f);
const Vec3f flush_colour(0.84f, 0.50f, 0.46f);
const Vec3f areola_colour(0.76f, 0.47f, 0.42f);
const Vec3f vernix_colour(0.95f, 0.91f, 0.84f);
const Vec3f hair_colour(0.36f, 0.27f, 0.21f);
const Vec3f lid_line_colour(0.50f, 0.29f, 0.26f);
constexpr float term_wetness = 0.10f, preterm_wetness = 0.34f;

// The head's middle and the axis about which the hairline runs.
const Vec3f head_middle(0.0f, -18.0f, 40.0f);
const Vec3f crown = Vec3f(0.0f, -0.55f, 0.835f);

float bell(float off, float width) {
    return std::exp(-off * off / (width * width));
}

float on_scalp(const Vec3f& p) {
    const Vec3f off = p - head_middle;
    const float away = off.norm();
    if (away > 95.0f || away < 1.0f) {
        return 0.0f;
    }
    const Vec3f way = off / away;
    // Low behind the ears and at the nape, higher over the temples.
    const float line = -0.16f - 0.14f * smoothstep(0.3f, -0.6f, way.y()) +
                       0.08f * smoothstep(0.5f, 0.8f, std::fabs(way.x())) * smoothstep(0.0f, 0.5f, way.y());
    const float ragged = 0.09f * (value_noise(0.16f * p) - 0.5f) + 0.06f * (value_noise(0.5f * p) - 0.5f);
    const float auricle = smoothstep(39.0f, 43.0f, std::fabs(p.x())) * smoothstep(36.0f, 28.0f, p.z()) *
                          smoothstep(-45.0f, -36.0f, p.y());
    return (1.0f - auricle) * smoothstep(line - 0.26f, line + 0.30f, way.dot(crown) + ragged);
}

float on_brow(const Vec3f& p) {
    const float side = std::fabs(p.x());
    const float bend = (side - 18.0f) / 11.0f;
    const float middle = 35.0f - 2.2f * bend * bend;
    return p.y() < 22.0f ? 0.0f
                         : bell(p.z() - middle, 1.7f) * smoothstep(6.0f, 10.0f, side) *
                               (1.0f - smoothstep(24.0f, 30.0f, side));
}

/// Downy regions: forehead, temples and cheeks, shoulders and upper arms.
float lanugo(const Vec3f& p) {
    const float face = smoothstep(-25.0f, -5.0f, p.z()) * smoothstep(14.0f, 24.0f, std::fabs(p.x()));
    const float forehead = smoothstep(34.0f, 42.0f, p.z());
    const float shoulders = smoothstep(-135.0f, -80.0f, p.z()) * (1.0f - smoothstep(-60.0f, -45.0f, p.z())) *
                            smoothstep(28.0f, 60.0f, std::fabs(p.x()));
    return std::max({face, forehead, shoulders});
}

/// Line between closed lids.
float on_lid_line(const Vec3f& p) {
    const float side = (std::fabs(p.x()) - 19.2f) / 9.3f;
    return p.y() < 28.0f ? 0.0f
                         : bell(p.z() - 24.3f - 1.3f * side * side, 0.75f) *
                               (1.0f - smoothstep(0.85f, 1.1f, std::fabs(side)));
}

}  // namespace

NewbornSkin::NewbornSkin(const Landmarks& rest)
    // A term newborn's glottis is 50 mm from the gum.
    : size_((at(rest, Landmark::glottis) - at(rest, Landmark::upper_gum)).norm() / 0.050f),
      prematurity_(smoothstep(0.9f, 0.68f, size_)) {}

Vec3f NewbornSkin::to_model(const Vec3f& point) const {
    return Vec3f(point.x(), -point.y(), point.z()) / (1e-3f * std::max(size_, 0.1f)) + upper_gum_model;
}

float NewbornSkin::hair(const Vec3f& p) const {
    const float scalp = std::lerp(0.78f, 0.45f, prematurity_) * on_scalp(p);
    const float brow = std::lerp(0.56f, 0.28f, prematurity_) * on_brow(p);
    return std::max({scalp, brow, 0.20f * prematurity_ * lanugo(p)});
}

float NewbornSkin::acral(const Vec3f& p) const {
    return std::max(smoothstep(132.0f, 165.0f, std::fabs(p.x())), smoothstep(-285.0f, -325.0f, p.z()));
}

NewbornSkin::Look NewbornSkin::look(const Vec3f& p, float sky) const {
    Look skin{term_colour + prematurity_ * (preterm_colour - term_colour),
              std::lerp(term_wetness, preterm_wetness, prematurity_)};
    const auto towards = [&](const Vec3f& colour, float share) {
        skin.colour += share * (colour - skin.colour);
    };
    const float side = std::fabs(p.x());
    // Blood nearer to the surface: cheeks, tip of the nose, lids, ears, palms and soles.
    const float cheeks =
        bell(side - 27.0f, 13.0f) * bell(p.z() + 2.0f, 14.0f) * smoothstep(15.0f, 35.0f, p.y());
    const float nose = bell(p.x(), 7.0f) * bell(p.z() - 8.0f, 6.0f) * smoothstep(50.0f, 57.0f, p.y());
    const float lids = bell(side - 19.0f, 9.0f) * bell(p.z() - 26.0f, 6.0f) * smoothstep(25.0f, 35.0f, p.y());
    const float ears =
        smoothstep(43.0f, 50.0f, side) * bell(p.z() - 8.0f, 20.0f) * bell(p.y() + 17.0f, 22.0f);
    const float patches = smoothstep(0.35f, 0.75f, value_noise(0.035f * p));
    towards(flush_colour,
            (1.0f - 0.6f * prematurity_) * std::max({0.38f * cheeks, 0.35f * nose, 0.5f * lids, 0.4f * ears,
                                                     0.35f * acral(p), 0.28f * patches}));
    const Vec3f nipple(30.3f, 44.0f - 8.0f * prematurity_, -83.6f - 6.5f * prematurity_);
    const float from_nipple = (Vec3f(side, p.y(), p.z()) - nipple).norm();
    towards(areola_colour,
            std::lerp(0.75f, 0.25f, prematurity_) * (1.0f - smoothstep(3.5f, 6.0f, from_nipple)));
    // Vernix stays in folds, where less of the sky is seen, and thinly on the back and scalp; there is little
    // before 36 weeks.
    const float clumps =
        smoothstep(0.45f, 0.62f, 0.6f * value_noise(0.12f * p) + 0.4f * value_noise(0.4f * p));
    const float vernix = (1.0f - prematurity_) * (1.0f - acral(p)) * clumps * smoothstep(0.78f, 0.5f, sky) *
                         (1.0f - smoothstep(-45.0f, -30.0f, p.z()));
    towards(vernix_colour, 0.7f * vernix);
    skin.wetness += 0.25f * vernix;
    towards(lid_line_colour, 0.55f * on_lid_line(p));
    towards(hair_colour, 0.42f * smoothstep(0.25f, 0.9f, hair(p)));
    return skin;
}

}  // namespace eti::render
