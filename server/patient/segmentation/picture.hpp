// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/png.hpp"
#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Colour (red, green, blue) of a label in pictures.
[[nodiscard]] std::array<std::uint8_t, 3> colour_of(Label label);

/// Picture of a segmentation (as Xiao et al. 2020, Fig. 3): axial, sagittal and coronal slices through
/// `centre` [m], with label colours over grey values, in radiological orientation (front or top up, patient's
/// right on the left; sagittal facing left); and a view from the patient's front left with skin and skull cut
/// open at the centre's sagittal plane. `pixels`: side of the square picture.
[[nodiscard]] imaging::Picture draw(const imaging::Volume& volume, const imaging::Mask& labels,
                                    const Vec3d& centre, int pixels = 1000);

}  // namespace eti::segmentation
