// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace eti {

/// What lies in mouth and throat, where a scenario has liquid.
enum class LiquidKind : std::uint8_t { saliva, blood };

inline constexpr std::array<std::string_view, 2> liquid_kind_names = {"saliva", "blood"};

/// How a liquid flows, and what it does to the eye beyond its colour.
struct LiquidProperties {
    float density;          ///< [kg/m^3]
    float viscosity;        ///< [m^2/s], kinematic
    float wall_viscosity;   ///< [m^2/s], of what clings to a wall and creeps
    float surface_tension;  ///< [N/m]
    float foaming;          ///< 0-1: air that it takes in and holds
    float stringing;        ///< 0-1: threads that it is drawn into
};

/// Saliva: unstimulated it is some five times as viscous as water; slow saliva is thicker by an order or two,
/// and what clings to the mucosa hardly flows.
/// Blood at 37 degrees: 1064 kg/m^3, 3.35 mPa s, 52 mN/m (Wesolowski & Mlynarczak 2019, Preprints
/// 2019070090; a newborn's is a little thinner, J Pediatr 1982;100:449). It is shear-thinning too, by less
/// than an order. It holds no foam to speak of and, before it clots, no thread.
inline constexpr std::array<LiquidProperties, 2> liquid_properties = {{
    {1000.0f, 5e-6f, 1e-4f, 0.055f, 1.0f, 1.0f},
    {1064.0f, 3.15e-6f, 2.5e-5f, 0.052f, 0.04f, 0.0f},
}};

[[nodiscard]] constexpr const LiquidProperties& properties_of(LiquidKind kind) {
    return liquid_properties[static_cast<std::size_t>(kind)];
}

[[nodiscard]] constexpr std::string_view name_of(LiquidKind kind) {
    return liquid_kind_names[static_cast<std::size_t>(kind)];
}

/// Saliva where nobody knows the name: what a newer server may have.
[[nodiscard]] constexpr LiquidKind liquid_kind_named(std::string_view name) {
    const auto found = std::ranges::find(liquid_kind_names, name);
    return found == liquid_kind_names.end() ? LiquidKind::saliva
                                            : static_cast<LiquidKind>(found - liquid_kind_names.begin());
}

}  // namespace eti
