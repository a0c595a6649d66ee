// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/newborn_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace eti {

namespace {

struct Growth {
    float age;                // [weeks]
    float weight;             // [kg]
    float head, head_spread;  // [m], mean and standard deviation
};

// Keen & Pearce 1988, Arch Dis Child 63 (means of boys and girls), every second week. At 22 weeks the head is
// interpolated: the table's 27.0 cm is implausible next to 21.0 and 21.3.
constexpr std::array<Growth, 11> growth = {{{22, 0.508f, 0.2115f, 0.011f},
                                            {24, 0.676f, 0.220f, 0.015f},
                                            {26, 0.909f, 0.242f, 0.014f},
                                            {28, 1.126f, 0.263f, 0.014f},
                                            {30, 1.433f, 0.284f, 0.031f},
                                            {32, 1.709f, 0.3005f, 0.023f},
                                            {34, 2.069f, 0.316f, 0.015f},
                                            {36, 2.667f, 0.3315f, 0.013f},
                                            {38, 3.240f, 0.345f, 0.0135f},
                                            {40, 3.582f, 0.3515f, 0.0105f},
                                            {42, 3.694f, 0.3535f, 0.012f}}};

float interpolate(float x, float Growth::*from, float Growth::*to) {
    std::size_t i = 1;
    while (i + 1 < growth.size() && growth[i].*from < x) {
        ++i;
    }
    const Growth& a = growth[i - 1];
    const Growth& b = growth[i];
    const float t = std::clamp((x - a.*from) / (b.*from - a.*from), 0.0f, 1.0f);
    return a.*to + t * (b.*to - a.*to);
}

// A weight is plausible within this factor of the median: about three of the table's standard deviations (15
// to 20 %) downwards and more upwards.
constexpr float lightest = 0.5f;
constexpr float heaviest = 1.7f;

}  // namespace

const std::array<ShapeField, 8> shape_fields = {{
    {"weight", "patient", "weight", "kg", 1.0f, 0.5f, 4.5f, &NewbornShape::weight,
     "Weight; lengths scale with its cube root"},
    {"gestational_age", "patient", "gestational age", "weeks", 1.0f, 22.0f, 42.0f,
     &NewbornShape::gestational_age,
     "Gestational age, by default that of the weight; the cranium follows it"},
    {"tongue_scale", "patient", "tongue scale", "", 1.0f, tongue_scale_range.low, tongue_scale_range.high,
     &NewbornShape::tongue_scale, "Scale of the tongue, 1 is normal; a large tongue hides the glottis"},
    {"mandible_scale", "patient", "mandible scale", "", 1.0f, 0.7f, 1.15f, &NewbornShape::mandible_scale,
     "Scale of the mandible's length, 1 is normal; a short mandible pushes the tongue back"},
    {"mouth_scale", "patient", "mouth scale", "", 1.0f, 0.7f, 1.2f, &NewbornShape::mouth_scale,
     "Scale of the mouth's width, 1 is normal"},
    {"head_scale", "patient", "head scale", "", 1.0f, head_scale_range.low, head_scale_range.high,
     &NewbornShape::head_scale, "Size of the cranium relative to that of weight and age"},
    {"larynx_anterior", "patient", "larynx forward", "mm", millimetre, 0.0f, 3.0f,
     &NewbornShape::larynx_anterior, "Anterior displacement of the larynx, in mm of a 3.5 kg newborn"},
    {"larynx_superior", "patient", "larynx upward", "mm", millimetre, 0.0f, 3.0f,
     &NewbornShape::larynx_superior, "Superior displacement of the larynx, in mm of a 3.5 kg newborn"},
}};

void apply(AirwayVariant variant, NewbornShape& shape) {
    // None of these is a mean of patients: each is far enough from normal to be difficult. No published norm
    // was found for the tongue's size in macroglossia (its assessment is said to be subjective).
    switch (variant) {
        case AirwayVariant::normal:
            break;
        case AirwayVariant::micrognathia:
            shape.mandible_scale = 0.8f;
            break;
        case AirwayVariant::macroglossia:
            shape.tongue_scale = 1.25f;
            break;
        case AirwayVariant::anterior_larynx:
            shape.larynx_anterior = 2.5e-3f;
            shape.larynx_superior = 2.0e-3f;
            break;
    }
}

float median_gestational_age(float weight) {
    return interpolate(weight, &Growth::weight, &Growth::age);
}

float median_weight(float gestational_age) {
    return interpolate(gestational_age, &Growth::age, &Growth::weight);
}

HeadCircumference mean_head_circumference(float gestational_age) {
    return {interpolate(gestational_age, &Growth::age, &Growth::head),
            interpolate(gestational_age, &Growth::age, &Growth::head_spread)};
}

WeightRange plausible_weights(float gestational_age) {
    const float usual = median_weight(gestational_age);
    return {lightest * usual, heaviest * usual};
}

std::string implausibility(const NewbornShape& shape) {
    for (const ShapeField& field : shape_fields) {
        const float typed = shape.*field.value / field.per_unit;
        const float slack = 1e-4f * (std::fabs(field.low) + std::fabs(field.high));
        if (!(typed >= field.low - slack && typed <= field.high + slack)) {
            return fmt::format("{} is {:g}; expected {:g} to {:g}", field.key(), typed, field.low,
                               field.high);
        }
    }
    if (!(shape.jaw_opening >= 0.0f && shape.jaw_opening <= 25.0f * degree)) {
        return fmt::format("the jaw opening is {:g} deg; expected 0 to 25", shape.jaw_opening / degree);
    }
    const auto [low, high] = plausible_weights(shape.gestational_age);
    if (shape.weight < low || shape.weight > high) {
        return fmt::format(
            "weight_kg is {:g} at gestational_age_weeks {:g}; expected {:.2f} to {:.2f}. Give the age of "
            "that weight, {:.0f}, or omit it",
            shape.weight, shape.gestational_age, low, high, median_gestational_age(shape.weight));
    }
    return {};
}

}  // namespace eti
