// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"

namespace eti {

using Triangle = std::array<std::uint32_t, 3>;

/// An indexed triangle mesh; vertices in metres, triangles counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Vec3f> vertices;
    std::vector<Triangle> triangles;
};

}  // namespace eti
