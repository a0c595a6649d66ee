// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

#include "common/math/transform.hpp"

namespace eti::devices {

/// Pose of the device relative to the patient, and of the tool relative to the device's moving part.
struct Calibration {
    bool registered = true;       ///< false: a pivot result with the tool only, not the patient
    std::string device;           ///< driver's name
    std::string date;             ///< UTC, ISO 8601
    RigidTransform to_patient;    ///< device frame to patient frame
    RigidTransform tool;          ///< tool frame to the frame of the device's moving part
    double error = 0.0;           ///< [m], FRE of to_patient, or RMS of the pivot
    double left_out_error = 0.0;  ///< [m], leave-one-out
    int points = 0;               ///< number of points used
};

/// Writes it as YAML, atomically. Throws InputError when the file cannot be written.
void save_calibration(const Calibration& calibration, const std::filesystem::path& file);

/// Reads and validates. Throws InputError.
[[nodiscard]] Calibration load_calibration(const std::filesystem::path& file);

/// Today's date, as in Calibration::date.
[[nodiscard]] std::string utc_now();

}  // namespace eti::devices
