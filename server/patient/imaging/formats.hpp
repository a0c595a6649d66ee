// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <span>
#include <string>

#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"

// File formats. Each reader throws VolumeError, starting with `file`, unless the data are one complete scalar
// volume with known position and directions. Readers omit the checks of require_valid() and require_finite(),
// which apply to every volume. read() in read.hpp runs them in a child process, where a crash is harmless.
namespace eti::imaging {

/// NRRD versions 1-5 in a single file, raw or gzip (teem.sourceforge.net/nrrd/format.html).
[[nodiscard]] Volume parse_nrrd(std::span<const std::uint8_t> data, const std::string& file);

/// Names of the segments by label value, as 3D Slicer stores them in a .seg.nrrd; empty for other files.
[[nodiscard]] std::map<int, std::string> parse_segment_names(std::span<const std::uint8_t> data,
                                                             const std::string& file);

/// NIfTI-1 in a single file, optionally compressed (nifti.nimh.nih.gov, nifti1.h). What the user should know
/// of a doubtful header is appended to `remarks`.
[[nodiscard]] Volume parse_nifti(std::span<const std::uint8_t> data, const std::string& file,
                                 std::vector<std::string>* remarks = nullptr);

/// An InVesalius 3 project: a tar archive, optionally compressed, of main.plist and the matrix that it names.
/// The format has no directions. As InVesalius stores them, axial slices are taken to run upwards, rows from
/// the back of the head to the nose, columns from the patient's right to the left.
[[nodiscard]] Volume parse_inv3(std::span<const std::uint8_t> data, const std::string& file);

/// CT slices of one series, or one multi-frame file, read with GDCM. A folder is searched with the folders in
/// it. What is no CT slice is left out and listed in `remarks`, in one line: DICOMDIR, reports, other
/// modalities, scout images, screen captures, objects without pixels, other series. Of several series the one
/// named `series` is read; without a name, the one with most slices among those that form a volume.
[[nodiscard]] Volume read_dicom(const std::filesystem::path& path, std::vector<std::string>& remarks,
                                const std::string& series = {});

enum class Format : std::uint8_t { nrrd, nifti };
/// Format by file name: .nrrd, .nii or .nii.gz; throws VolumeError for any other.
[[nodiscard]] Format format_of(const std::filesystem::path& file);

/// Encodes a whole file. `data`: voxels as `type`, u8 or i16, little-endian.
[[nodiscard]] Bytes encode_nrrd(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data);
[[nodiscard]] Bytes encode_nifti(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data);

}  // namespace eti::imaging
