// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <vector>

#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Whether a file's name is that of a surface (STL, OBJ, PLY).
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);

/// Labels from closed surfaces; each file's name tells what it bounds: skin (or body, head), airway, bone (or
/// skull), mandible (or jaw), spine, tongue, epiglottis. Several files may bound one structure. Where they
/// overlap, airway counts more than mandible, spine, bone, epiglottis, tongue and skin, in this order. Throws
/// VolumeError where a surface is not closed, with the place, or its name says nothing.
[[nodiscard]] imaging::Mask voxelise(const std::vector<std::filesystem::path>& files, double spacing,
                                     const Progress& progress);

}  // namespace eti::segmentation
