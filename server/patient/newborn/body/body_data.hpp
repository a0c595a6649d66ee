// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace eti::patient {

/// An eyeball behind closed lids, in model coordinates [mm].
struct BodyEye {
    std::array<float, 3> centre;
    float radius;
};

/// The closed surface of a newborn's body, written at build time by bake.py; empty if its source was not at
/// hand. Coordinates are the newborn's model coordinates (x left, y anterior, z superior) in units of
/// `body_unit_mm`.
struct BodyData {
    std::span<const std::int16_t> term;            ///< [vertices, 3]
    std::span<const std::int16_t> preterm_change;  ///< [vertices, 3], to 28 weeks
    std::span<const std::uint16_t> triangles;      ///< [triangles, 3]
    std::span<const BodyEye> eyes;
};

constexpr float body_unit_mm = 0.0125f;

[[nodiscard]] BodyData body_data();

}  // namespace eti::patient
