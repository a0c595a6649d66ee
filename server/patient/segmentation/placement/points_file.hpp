// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Whether a points file may use this name: the patient's landmarks (common/model/landmark.hpp) and these,
/// each a point inside the structure: "mandible" (the chin), "skull", "spine" (one or more), "tongue",
/// "mouth" (between the lips).
[[nodiscard]] bool is_known_point(const std::string& name);

/// Reads a points file of 3D Slicer (markups, *.mrk.json), in mm, LPS or RAS. Throws imaging::VolumeError
/// naming file, finding, expectation and remedy. Points without a defined position are left out and listed in
/// `remarks`.
[[nodiscard]] Points read_points(const std::filesystem::path& file, std::vector<std::string>& remarks);

/// Encodes such a file, in LPS.
[[nodiscard]] std::string encode_points(const Points& points);

}  // namespace eti::segmentation
