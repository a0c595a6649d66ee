// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "server/patient/imaging/volume.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

struct PhantomSettings {
    NewbornShape newborn;
    float spacing = 0.6e-3f;  ///< [m] between voxels; half of it takes eight times as long
    float noise = 20.0f;      ///< [HU], standard deviation
    std::uint64_t seed = 1;   ///< of the noise
};

/// A CT of the parametric newborn and the truth about it.
struct Phantom {
    imaging::Volume ct;
    imaging::Mask labels;  ///< Label of the largest share of each voxel
    Points landmarks;
};

/// Hounsfield units of a phantom. Tongue against neighbouring soft tissue stays within 20 HU, as in
/// life; a newborn's bone is little mineralised.
[[nodiscard]] float hounsfield_of(Label label);

/// Samples the newborn: a voxel next to a border is the mean over 3 x 3 x 3 points within it. Below, the
/// volume cuts through the shoulders; on the other sides there is air.
[[nodiscard]] Phantom make_phantom(const PhantomSettings& settings, const Progress& progress);

}  // namespace eti::segmentation
