// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/model/field.hpp"

namespace eti {

/// Well-known forms of the newborn's airway, each a preset of shape parameters.
enum class AirwayVariant : std::uint8_t { normal, micrognathia, macroglossia, anterior_larynx };
inline constexpr std::array<std::string_view, 4> airway_variant_names = {"normal", "micrognathia",
                                                                         "macroglossia", "anterior-larynx"};

/// Everything that shapes the parametric newborn. Scenarios, the CT phantom and the model builder share it.
struct NewbornShape {
    float weight = 3.5f;            ///< [kg]; lengths go with its cube root
    float gestational_age = 40.0f;  ///< [weeks]; the cranium's size follows it
    float tongue_scale = 1.0f;
    float mandible_scale = 1.0f;   ///< length from joint to chin
    float mouth_scale = 1.0f;      ///< width between the corners of the mouth
    float head_scale = 1.0f;       ///< cranium, relative to that of weight and age
    float larynx_anterior = 0.0f;  ///< [m], of a 3.5 kg newborn, forward of its usual place
    float larynx_superior = 0.0f;  ///< [m], of a 3.5 kg newborn, above its usual place
    /// [rad], mouth opening beyond the slightly parted lips in which the newborn is modelled. A scenario
    /// poses the model instead; this one opens the mouth in a phantom's volume.
    float jaw_opening = 0.0f;

    [[nodiscard]] bool operator==(const NewbornShape&) const = default;
};

/// As typed.
struct TypedRange {
    float low, high;
};
inline constexpr TypedRange tongue_scale_range{0.8f, 1.4f};
inline constexpr TypedRange head_scale_range{0.85f, 1.15f};

using ShapeField = Field<NewbornShape>;

/// Every shape parameter that a person may set, in the order of display. Scenario reader, command line,
/// provenance and random sampling walk this list.
extern const std::array<ShapeField, 8> shape_fields;

/// Sets what makes a variant; the rest stays.
void apply(AirwayVariant variant, NewbornShape& shape);

/// Median gestational age [weeks] of newborns of a weight [kg], 22-42.
[[nodiscard]] float usual_gestational_age(float weight);
/// Median weight [kg] of newborns of a gestational age [weeks].
[[nodiscard]] float usual_weight(float gestational_age);
/// Mean head circumference [m] of newborns of a gestational age [weeks], and its standard deviation.
struct HeadCircumference {
    float mean, deviation;
};
[[nodiscard]] HeadCircumference usual_head_circumference(float gestational_age);

/// What newborns of a gestational age [weeks] may weigh [kg].
struct WeightRange {
    float low, high;
};
[[nodiscard]] WeightRange plausible_weights(float gestational_age);

/// Why no newborn has this shape (a parameter out of range, weight and age that do not go together), or
/// nothing.
[[nodiscard]] std::string implausible(const NewbornShape& shape);

}  // namespace eti
