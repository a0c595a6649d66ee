// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

namespace eti {

/// 0 at `from`, 1 at `to` and beyond, zero slope at both; maximum slope 1.5 / (to - from) half-way. As in
/// GLSL, except that `from` may exceed `to`.
[[nodiscard]] inline float smoothstep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

}  // namespace eti
