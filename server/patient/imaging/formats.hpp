// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string>

#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"

// The file formats. Each reader throws VolumeError, beginning with `file`, on anything but one whole
// scalar volume with known place and directions. None checks what require_sound() and
// require_finite() check of every volume. read() in read.hpp runs them where a crash does no harm.
namespace eti::imaging {

/// NRRD versions 1-5 in one file, raw or gzip (teem.sourceforge.net/nrrd/format.html).
[[nodiscard]] Volume parse_nrrd(std::span<const std::uint8_t> data, const std::string& file);

/// NIfTI-1 in one file, compressed or not (nifti.nimh.nih.gov, nifti1.h).
[[nodiscard]] Volume parse_nifti(std::span<const std::uint8_t> data, const std::string& file);

/// An InVesalius 3 project: a tar archive, compressed or not, of main.plist and the matrix it names.
/// It says nothing of directions: axial slices are taken as stored from below upwards, rows from the
/// back of the head to the nose, columns from the patient's right to the left, as InVesalius stores them.
[[nodiscard]] Volume parse_inv3(std::span<const std::uint8_t> data, const std::string& file);

/// CT slices of one series, or one multi-frame file, read with GDCM. Of several series in the folder the
/// one with most slices is taken and the others are named in `remarks`.
[[nodiscard]] Volume read_dicom(const std::filesystem::path& folder, std::vector<std::string>& remarks);

enum class Format : std::uint8_t { nrrd, nifti };
/// By the file's name: .nrrd, .nii or .nii.gz; throws VolumeError for any other.
[[nodiscard]] Format format_of(const std::filesystem::path& file);

/// The whole file. `data` holds the voxels as `type`, u8 or i16, little-endian.
[[nodiscard]] Bytes encode_nrrd(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data);
[[nodiscard]] Bytes encode_nifti(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data);

}  // namespace eti::imaging
