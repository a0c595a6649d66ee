// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

namespace eti::bench {

/// Blocks of the solver's elements against independent references: a bar under its own weight, a sphere and a
/// blade pressed in. One object per load: case, element, nu, cell_mm, depth_mm, value, reference, error
/// (relative), steps_to_rest and, of the blade, shape_error (relative, RMS over points of the top).
[[nodiscard]] nlohmann::ordered_json reference_blocks(bool quick);

}  // namespace eti::bench
