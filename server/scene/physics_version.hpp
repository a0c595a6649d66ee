// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::scene {

/// Names what the simulation computes: the state after a canonical run, which `docs/stamps.py --update`
/// writes here. Recordings and measured tables of another version are of another physics.
inline constexpr std::string_view physics_version = "9c73c254";

}  // namespace eti::scene
