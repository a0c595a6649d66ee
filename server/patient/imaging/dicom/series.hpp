// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/patient/imaging/dicom/header.hpp"

// Slices sorted by series, and the series that is read.
namespace eti::imaging {

/// What keeps slices from forming a volume, for refuse_dicom().
struct SeriesFault {
    std::string file;
    std::string found, expected, remedy;
};

struct DicomSeries {
    std::string name;                     ///< Series Instance UID
    std::string description;              ///< Series Description
    std::vector<DicomHeader> files;       ///< sorted along the normal
    std::size_t in_other_directions = 0;  ///< images left out: scouts that are not labelled as such
    std::optional<SeriesFault> fault;

    [[nodiscard]] std::size_t slices() const;
    /// For messages: "1.2.3 ('Head 1.0 soft', 120 slices)".
    [[nodiscard]] std::string label() const;
};

/// Sorts CT slices by series. Images in another direction than most of their series are left out.
[[nodiscard]] std::vector<DicomSeries> sort_by_series(std::vector<DicomHeader> slices,
                                                      const std::string& folder);

/// What keeps sorted slices of one image each from forming a volume: size, spacing, directions, distances.
[[nodiscard]] std::optional<SeriesFault> find_series_fault(const std::vector<std::string>& files,
                                                           const std::vector<Geometry>& geometries,
                                                           const std::string& folder);

/// The series named `wanted`; if that is empty, the one with most slices among those that form a volume.
/// Throws VolumeError listing all series if there is no such series or if several have most slices.
[[nodiscard]] const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const std::string& wanted,
                                               const std::string& folder);

}  // namespace eti::imaging
