// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>

#include "server/patient/imaging/volume.hpp"

namespace gdcm {
class DataSet;
class Tag;
}  // namespace gdcm

// What the header of a DICOM file says, without its pixels.
namespace eti::imaging {

struct DicomHeader {
    std::string file;
    std::string series;       ///< Series Instance UID
    std::string description;  ///< Series Description
    /// Why it is no CT slice, as a noun in the singular ("DICOMDIR", "MR image"); empty for a slice.
    std::string foreign;
    /// Third column: zero. Frames of a multi-frame file are counted as the third size; their position and
    /// directions may be absent here.
    Geometry geometry;
};

/// Whether a file begins with a preamble of 128 bytes and "DICM" (PS3.10, 7.1).
[[nodiscard]] bool is_dicom(const std::filesystem::path& file);

/// Reads a header. Throws VolumeError if the file is damaged there.
[[nodiscard]] DicomHeader read_dicom_header(const std::filesystem::path& file);

/// The text of an element without trailing spaces; empty if it is absent or longer than 256 bytes.
[[nodiscard]] std::string element_text(const gdcm::DataSet& data, const gdcm::Tag& tag);

[[noreturn]] void refuse_dicom(const std::string& file, const std::string& found, const std::string& expected,
                               const std::string& remedy);

}  // namespace eti::imaging
