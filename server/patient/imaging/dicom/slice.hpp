// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/patient/imaging/dicom/header.hpp"

namespace eti::imaging {

/// Image of one file: a slice, or several stacked frames.
struct DicomFrames {
    std::string file;
    Geometry geometry;         ///< third column: step between frames, zero for a single one
    std::vector<float> value;  ///< [HU]
};

/// Reads the pixels of a CT file. Throws VolumeError.
[[nodiscard]] DicomFrames read_dicom_frames(const std::filesystem::path& path);

}  // namespace eti::imaging
