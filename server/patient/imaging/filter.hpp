// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// Filters on voxels of equal spacing along all axes; lengths in voxels. Masks hold 0 or 1, x fastest.
namespace eti::imaging {

using Size = std::array<int, 3>;
using Bits = std::vector<std::uint8_t>;

/// Distance [voxels] from each voxel's centre to the nearest set voxel's centre; 0 in the mask, more than
/// 1e9 where nothing is set. Exact, in linear time (Felzenszwalb & Huttenlocher 2012, Theory of Computing 8).
[[nodiscard]] std::vector<float> distance_to(const Size& size, std::span<const std::uint8_t> mask);

/// Closing by a ball of `radius` [voxels]: fills what no ball of this radius outside the mask can reach.
/// Beyond the volume's faces lies empty space (the mask is padded), so that nothing grows along them.
[[nodiscard]] Bits close(const Size& size, std::span<const std::uint8_t> mask, float radius);

/// Gaussian mean over the mask's voxels alone, so that what lies beside the mask does not bleed in
/// (normalised convolution, Knutsson & Westin 1993). Outside the
/// mask it is the mean of the mask's voxels in reach, 0 where there is none. `sigma` in voxels.
[[nodiscard]] std::vector<float> smooth_within(const Size& size, std::span<const float> value,
                                               std::span<const std::uint8_t> mask, float sigma);

/// Parts a mask at its necks (watershed with markers, Meyer 1994, Signal Processing 38): each voxel goes to
/// the marker (number > 0 in `markers`) from which the way to it within the mask stays highest, of equals
/// to the nearer one; 0 where no marker can be reached. `height` is best the distance to the mask's
/// surface. Ways lead through voxels' faces.
struct Watershed {
    std::vector<std::uint8_t> owner;
    float neck = 0.0f;  ///< height of the highest pass between areas of different markers, 0 without one
};
[[nodiscard]] Watershed watershed(const Size& size, std::span<const std::uint8_t> mask,
                                  std::span<const float> height, std::span<const std::uint8_t> markers);

}  // namespace eti::imaging
