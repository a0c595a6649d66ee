// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// Where a model came from: generator, version, and every parameter that it depends on.
using Provenance = std::map<std::string, std::string>;

/// Writes a patient to one HDF5 file. The file appears under its name only when it is complete; one
/// that stood there is replaced. Throws hdf5::Error, also for a patient that load_patient would refuse.
void save_patient(const Patient& patient, const std::filesystem::path& path, const Provenance& provenance);

/// Reads a patient and checks everything that the server relies on: sizes agree, indices are in
/// range, numbers are finite, weights sum to one. Throws hdf5::Error naming file and data set.
[[nodiscard]] Patient load_patient(const std::filesystem::path& path);

/// The provenance alone, quick to read. Throws hdf5::Error.
[[nodiscard]] Provenance load_provenance(const std::filesystem::path& path);

}  // namespace eti::anatomy
