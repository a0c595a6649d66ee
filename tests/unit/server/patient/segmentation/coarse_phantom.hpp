// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <tuple>

#include "server/patient/segmentation/phantom.hpp"

namespace eti::segmentation::test {

inline const Progress silent = [](float, std::string_view) { return true; };

/// A noisy term newborn, coarse enough for tests; built once per program.
inline const Phantom& coarse_phantom(float spacing = 1.0e-3f, float weight = 3.5f, std::uint64_t seed = 1) {
    static std::map<std::tuple<float, float, std::uint64_t>, Phantom> made;
    const auto [it, is_new] = made.try_emplace({spacing, weight, seed});
    if (is_new) {
        PhantomSettings settings;
        settings.newborn.weight = weight;
        settings.spacing = spacing;
        settings.seed = seed;
        it->second = make_phantom(settings, silent);
    }
    return it->second;
}

}  // namespace eti::segmentation::test
