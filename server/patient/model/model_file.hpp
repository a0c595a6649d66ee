// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// Origin of a model: generator, version, and every parameter that it depends on.
using Provenance = std::map<std::string, std::string>;

/// Writes a patient to an HDF5 file. The file is written atomically and replaces an existing one. Throws
/// hdf5::Error, also for a patient that load_patient() would reject.
void save_patient(const Patient& patient, const std::filesystem::path& path, const Provenance& provenance);

/// Reads and validates a patient: sizes agree, indices are in range, numbers are finite, weights sum to one.
/// Throws hdf5::Error naming file and data set.
[[nodiscard]] Patient load_patient(const std::filesystem::path& path);

/// Reads the provenance only, which is fast. Throws hdf5::Error.
[[nodiscard]] Provenance load_provenance(const std::filesystem::path& path);

}  // namespace eti::patient
