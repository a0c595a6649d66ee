// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/segmentation/phantom.hpp"

namespace eti::segmentation::test {

inline const Progress silent = [](float, std::string_view) { return true; };

/// A noisy term newborn, coarse enough for tests.
inline Phantom coarse_phantom(float spacing = 1.0e-3f, float weight = 3.5f, std::uint64_t seed = 1) {
    PhantomSettings settings;
    settings.newborn.weight = weight;
    settings.spacing = spacing;
    settings.seed = seed;
    return make_phantom(settings, silent);
}

}  // namespace eti::segmentation::test
