// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

/// Standard deviation of the noise [HU] in soft tissue. Second differences along rows and columns cancel
/// slopes of the image, and their median ignores borders (as in Immerkaer 1996, Comput Vis Image Underst
/// 64:300, with the median of Donoho & Johnstone 1994, Biometrika 81:425). Noise that a reconstruction kernel
/// has smoothed is underestimated. 0 without soft tissue.
[[nodiscard]] float estimate_noise(const imaging::Volume& volume);

/// Factor by which a Gaussian mean of standard deviation `sigma` [voxels, at least 1] reduces white noise.
[[nodiscard]] float noise_after_smoothing(float sigma);

}  // namespace eti::segmentation
