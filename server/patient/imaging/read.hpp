// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/process/guard.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

/// A volume as it was read, and what a person should know of how.
struct Reading {
    Volume volume;
    std::vector<std::string> remarks;
};

/// Parses a DICOM folder or file, NRRD, NIfTI or an InVesalius project, told apart by their first
/// bytes. Throws VolumeError naming file, finding, expectation and remedy; the volume is sound and all
/// its values are finite. A library that crashes takes the calling process along: use read().
[[nodiscard]] Reading parse(const std::filesystem::path& path);

/// parse() in a child process with bounded time and memory: a crash or a hang in there is a
/// VolumeError here.
[[nodiscard]] Reading read(const std::filesystem::path& path, const GuardLimits& limits = {});

/// Runs a parser of foreign data in a child process with bounded time and memory and hands back what it
/// made. Its VolumeErrors arrive here; a crash or a hang in there is a VolumeError that names `name`.
[[nodiscard]] Bytes run_parser(const std::function<Bytes()>& parse, const std::string& name,
                               const GuardLimits& limits);

/// Writes CT as 16 bit integers, labels as 8 bit, in the format of the file's name (.nrrd, .nii,
/// .nii.gz). The file is whole or not there. Throws VolumeError.
void write(const Volume& volume, const std::filesystem::path& file);
void write(const Mask& labels, const std::filesystem::path& file);

}  // namespace eti::imaging
