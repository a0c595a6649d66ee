// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/model/field.hpp"

namespace eti {

/// Well-known variants of the newborn's airway, each a preset of shape parameters.
enum class AirwayVariant : std::uint8_t { normal, micrognathia, macroglossia, anterior_larynx };
inline constexpr std::array<std::string_view, 4> airway_variant_names = {"normal", "micrognathia",
                                                                         "macroglossia", "anterior-larynx"};

/// All shape parameters of the parametric newborn, shared by scenarios, the CT phantom and the model builder.
struct NewbornShape {
    float weight = 3.5f;            ///< [kg]; lengths scale with its cube root
    float gestational_age = 40.0f;  ///< [weeks]; the cranium's size follows it
    float tongue_scale = 1.0f;
    float mandible_scale = 1.0f;   ///< length from joint to chin
    float mouth_scale = 1.0f;      ///< width between the corners of the mouth
    float head_scale = 1.0f;       ///< cranium, relative to the mean for weight and age
    float larynx_anterior = 0.0f;  ///< [m], of a 3.5 kg newborn, anterior to its normal position
    float larynx_superior = 0.0f;  ///< [m], of a 3.5 kg newborn, superior to its normal position
    /// [rad], mouth opening beyond the slightly parted lips of the rest model. Only for a phantom's volume; a
    /// scenario poses the model instead.
    float jaw_opening = 0.0f;

    [[nodiscard]] bool operator==(const NewbornShape&) const = default;
};

/// Range in typed units.
struct TypedRange {
    float low, high;
};
inline constexpr TypedRange tongue_scale_range{0.8f, 1.4f};
inline constexpr TypedRange head_scale_range{0.85f, 1.15f};

using ShapeField = Field<NewbornShape>;

/// Every shape parameter that a person may set, in display order. Scenario reader, command line, provenance
/// and random sampling iterate over this list.
extern const std::array<ShapeField, 8> shape_fields;

/// Sets the parameters that define a variant; leaves the others unchanged.
void apply(AirwayVariant variant, NewbornShape& shape);

/// Median gestational age [weeks] for a weight [kg], 22-42.
[[nodiscard]] float median_gestational_age(float weight);
/// Median weight [kg] for a gestational age [weeks].
[[nodiscard]] float median_weight(float gestational_age);
/// Mean and standard deviation [m] of the head circumference at a gestational age [weeks].
struct HeadCircumference {
    float mean, deviation;
};
[[nodiscard]] HeadCircumference mean_head_circumference(float gestational_age);

/// Plausible weights [kg] at a gestational age [weeks].
struct WeightRange {
    float low, high;
};
[[nodiscard]] WeightRange plausible_weights(float gestational_age);

/// Why the shape is implausible (a parameter out of range, weight and age that do not match); empty if it is
/// plausible.
[[nodiscard]] std::string implausibility(const NewbornShape& shape);

}  // namespace eti
