// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <vector>

#include "devices/calibration/rigid_fit.hpp"

namespace eti::devices {

/// Named points with their positions in the patient frame and, if measured, in the device frame: a YAML list
/// `points` of name, patient_mm, device_mm. Throws InputError.
[[nodiscard]] std::vector<PointPair> load_points(const std::filesystem::path& file, bool measured);

/// Poses of a sensor, one per line: x y z [mm] and a quaternion w x y z, separated by commas or blanks; lines
/// that begin with # are skipped. Throws InputError naming the line.
[[nodiscard]] std::vector<Eigen::Isometry3d> load_poses(const std::filesystem::path& file);

}  // namespace eti::devices
