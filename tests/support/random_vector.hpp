// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/random.hpp"
#include "common/math/transform.hpp"

namespace eti::test {

/// Three normally distributed numbers.
inline Vec3f random_vector(Random& random) {
    return {random.normal(), random.normal(), random.normal()};
}

}  // namespace eti::test
