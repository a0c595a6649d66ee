// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/png.hpp"
#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Red, green, blue of a label in pictures.
[[nodiscard]] std::array<std::uint8_t, 3> colour_of(Label label);

/// What a segmentation looks like (as Xiao et al. 2020, Fig. 3): axial, sagittal and coronal slices through
/// `centre` [m] with the labels' colours over the grey values, seen as radiologists do (front or top up, the
/// patient's right on the left; sagittal facing left), and from the patient's left and front a view in
/// which skin and skull are cut open at the centre's sagittal plane. `pixels` is the side of the square
/// picture.
[[nodiscard]] imaging::Picture draw(const imaging::Volume& volume, const imaging::Mask& labels,
                                    const Vec3d& centre, int pixels = 1000);

}  // namespace eti::segmentation
