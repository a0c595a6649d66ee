// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <vector>

#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Whether the file name is that of a surface (STL, OBJ, PLY).
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);

/// Labels from closed surfaces; the file name gives the structure: skin (or body, head), airway, bone (or
/// skull), mandible (or jaw), spine, tongue, epiglottis. A structure may have several files. In overlaps,
/// precedence is airway, mandible, spine, bone, epiglottis, tongue, skin. Throws VolumeError, with the
/// location, if a surface is not closed, or if a file name names no structure.
[[nodiscard]] imaging::Mask voxelise(const std::vector<std::filesystem::path>& files, double spacing,
                                     const Progress& progress);

}  // namespace eti::segmentation
