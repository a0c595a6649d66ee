// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/process/guard.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

/// A volume as read, with remarks for the user.
struct LoadedVolume {
    Volume volume;
    std::vector<std::string> remarks;
    std::map<int, std::string> segments;  ///< names by label value, where the file has them
};

/// Parses a DICOM folder or file, NRRD, NIfTI or an InVesalius project, distinguished by their first bytes.
/// The volume is valid and all its values are finite. Throws VolumeError naming file, finding, expectation
/// and remedy. `series`: see read_dicom(). A crash in a library would take the caller's process down: use
/// read().
[[nodiscard]] LoadedVolume parse(const std::filesystem::path& path, const std::string& series = {});

/// Runs parse() in a child process with bounded time and memory: a crash or hang becomes a VolumeError.
[[nodiscard]] LoadedVolume read(const std::filesystem::path& path, const GuardLimits& limits = {},
                                const std::string& series = {});

/// Runs a parser of untrusted data in a child process with bounded time and memory, and returns its result.
/// Its VolumeErrors are rethrown; a crash or hang becomes a VolumeError that names `name`.
[[nodiscard]] Bytes run_parser(const std::function<Bytes()>& parse, const std::string& name,
                               const GuardLimits& limits);

/// Writes CT as 16 bit integers, labels as 8 bit, in the format of the file's name (.nrrd, .nii, .nii.gz).
/// The file is complete or absent. Throws VolumeError.
void write(const Volume& volume, const std::filesystem::path& file);
void write(const Mask& labels, const std::filesystem::path& file);

}  // namespace eti::imaging
