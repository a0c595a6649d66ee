// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// Filters on isotropic voxels; lengths in voxels. Masks are 0 or 1, x fastest.
namespace eti::imaging {

using Size = std::array<int, 3>;
using Bits = std::vector<std::uint8_t>;

/// Distance [voxels] from each voxel's centre to the nearest set voxel's centre; 0 in the mask, above 1e9 if
/// the mask is empty. Exact, in linear time (Felzenszwalb & Huttenlocher 2012, Theory of Computing 8).
[[nodiscard]] std::vector<float> distance_to(const Size& size, std::span<const std::uint8_t> mask);

/// Morphological closing by a ball of `radius` [voxels]: fills what no ball of this radius outside the mask
/// can reach. The mask is padded with empty space, so that nothing grows along the volume's faces.
[[nodiscard]] Bits morphological_close(const Size& size, std::span<const std::uint8_t> mask, float radius);

/// Gaussian mean restricted to the mask's voxels (normalised convolution, Knutsson & Westin 1993), so that
/// values outside do not bleed in. Outside the mask: the mean of the mask's voxels within reach, 0 if there
/// are none. `sigma` in voxels.
[[nodiscard]] std::vector<float> smooth_within(const Size& size, std::span<const float> value,
                                               std::span<const std::uint8_t> mask, float sigma);

/// Splits a mask at its necks (watershed with markers, Meyer 1994, Signal Processing 38). Each voxel is
/// assigned to the marker (`markers` > 0) whose path to it within the mask stays highest; among equals, to
/// the nearer one; 0 if no marker reaches it. `height` is best the distance to the mask's surface. Paths are
/// face-connected.
struct Watershed {
    std::vector<std::uint8_t> owner;
    float neck = 0.0f;  ///< height of the highest pass between different markers; 0 without one
};
[[nodiscard]] Watershed watershed(const Size& size, std::span<const std::uint8_t> mask,
                                  std::span<const float> height, std::span<const std::uint8_t> markers);

}  // namespace eti::imaging
