// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace eti {

/// The liquid in mouth and throat, where a scenario has one.
enum class LiquidKind : std::uint8_t { saliva, blood };

inline constexpr std::array<std::string_view, 2> liquid_kind_names = {"saliva", "blood"};

/// Flow properties of a liquid, and its optical properties beyond colour.
struct LiquidProperties {
    float density;          ///< [kg/m^3]
    float viscosity;        ///< [m^2/s], kinematic
    float wall_viscosity;   ///< [m^2/s], of the film that clings to a wall and creeps
    float surface_tension;  ///< [N/m]
    float foaming;          ///< 0-1: tendency to entrain and hold air
    float stringing;        ///< 0-1: tendency to form threads
};

/// Saliva: unstimulated it is about five times as viscous as water; at low shear it is thicker by one or two
/// orders of magnitude, and the film on the mucosa hardly flows.
/// Blood at 37 degrees: 1064 kg/m^3, 3.35 mPa s, 52 mN/m (Wesolowski & Mlynarczak 2019, Preprints 2019070090;
/// a newborn's is a little thinner, J Pediatr 1982;100:449). It is shear-thinning too, by less than an order
/// of magnitude. It holds no significant foam and, before it clots, forms no threads.
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

/// Saliva for an unknown name, which a newer server may send.
[[nodiscard]] constexpr LiquidKind liquid_kind_named(std::string_view name) {
    const auto found = std::ranges::find(liquid_kind_names, name);
    return found == liquid_kind_names.end() ? LiquidKind::saliva
                                            : static_cast<LiquidKind>(found - liquid_kind_names.begin());
}

}  // namespace eti
