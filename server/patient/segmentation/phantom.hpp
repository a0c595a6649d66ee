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
    /// [rad], of the scanner's gantry about left-right: slices are inclined, and each is shifted against the
    /// last.
    float gantry_tilt = 0.0f;
    std::uint64_t seed = 1;  ///< seed of the noise
};

/// A CT of the parametric newborn with its ground truth.
struct Phantom {
    imaging::Volume ct;
    imaging::Mask labels;  ///< majority label of each voxel
    Points landmarks;
};

/// Hounsfield units in a phantom. Tongue and neighbouring soft tissue differ by at most 20 HU, as in vivo; a
/// newborn's bone is weakly mineralised.
[[nodiscard]] float hounsfield_of(Label label);

/// Samples the newborn: a voxel at a border is the mean over 3 x 3 x 3 points in it. The lower face cuts
/// through the shoulders; the other sides are in air.
[[nodiscard]] Phantom make_phantom(const PhantomSettings& settings, const Progress& progress);

}  // namespace eti::segmentation
