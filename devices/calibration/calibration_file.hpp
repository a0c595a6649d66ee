// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

#include "common/math/transform.hpp"

namespace eti::devices {

/// Where a device stands to the patient, and the tool to what the device measures.
struct Calibration {
    bool registered = true;       ///< false: of a pivot, which knows the tool and not the patient
    std::string device;           ///< driver's name
    std::string date;             ///< UTC, ISO 8601
    RigidTransform to_patient;    ///< device frame to patient frame
    RigidTransform tool;          ///< tool frame to the frame of the device's moving part
    double error = 0.0;           ///< [m], FRE of to_patient, or RMS of the pivot
    double left_out_error = 0.0;  ///< [m], leave-one-out
    int points = 0;               ///< used
};

/// Writes it as YAML, whole or not at all. Throws InputError when the file cannot be written.
void save_calibration(const Calibration& calibration, const std::filesystem::path& file);

/// Reads and validates. Throws InputError.
[[nodiscard]] Calibration load_calibration(const std::filesystem::path& file);

/// Today, as in Calibration::date.
[[nodiscard]] std::string utc_now();

}  // namespace eti::devices
