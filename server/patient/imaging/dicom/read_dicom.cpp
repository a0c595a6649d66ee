// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gdcmTrace.h>

#include <fmt/format.h>
#include <algorithm>
#include <map>

#include "server/patient/imaging/dicom/series.hpp"
#include "server/patient/imaging/dicom/slice.hpp"
#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

/// Files of a folder and of those in it; links to folders are not followed.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             folder, std::filesystem::directory_options::skip_permission_denied)) {
        if (entry.is_regular_file()) {
            files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    return files;
}

/// Counts of what is left out, by name.
class LeftOut {
  public:
    void add(const std::string& what, std::size_t count = 1) {
        if (count > 0) {
            counts_[what] += count;
        }
    }
    [[nodiscard]] bool empty() const { return counts_.empty(); }
    /// "1 DICOMDIR, 2 MR images, 3 objects without pixels".
    [[nodiscard]] std::string text() const {
        std::string out;
        for (const auto& [what, count] : counts_) {
            std::string noun = what;
            if (count > 1) {
                const std::size_t end = noun.find(" without");
                const std::size_t head = end == std::string::npos ? noun.find(" in another") : end;
                noun.insert(std::min(head, noun.size()), "s");
            }
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, noun);
        }
        return out;
    }

  private:
    std::map<std::string, std::size_t> counts_;
};

/// Stacks the slices of one series, which are sorted.
Volume stack(std::vector<DicomFrames>& slices, const std::string& folder) {
    std::vector<std::string> files;
    std::vector<Geometry> geometries;
    for (const DicomFrames& slice : slices) {
        files.push_back(slice.file);
        geometries.push_back(slice.geometry);
    }
    // The pixels' own geometry counts: GDCM reads it from other elements, too.
    if (const auto fault = find_series_fault(files, geometries, folder)) {
        refuse_dicom(fault->file, fault->found, fault->expected, fault->remedy);
    }
    Volume volume;
    volume.geometry = geometries.front();
    volume.geometry.size[2] = static_cast<int>(slices.size());
    if (slices.size() > 1) {
        volume.geometry.step.col(2) =
            (geometries.back().origin - geometries.front().origin) / static_cast<double>(slices.size() - 1);
    }
    volume.value.reserve(volume.geometry.count());
    for (const DicomFrames& slice : slices) {
        volume.value.insert(volume.value.end(), slice.value.begin(), slice.value.end());
    }
    return volume;
}

}  // namespace

Volume read_dicom(const std::filesystem::path& path, std::vector<std::string>& remarks,
                  const std::string& wanted) {
    gdcm::Trace::SetDebug(false);
    gdcm::Trace::SetWarning(false);
    gdcm::Trace::SetError(false);
    const std::string place = path.string();
    const bool folder = std::filesystem::is_directory(path);
    LeftOut left_out;
    std::vector<DicomHeader> slices;
    std::size_t dicom_files = 0;
    for (const auto& file : folder ? files_in(path) : std::vector{path}) {
        if (!is_dicom(file)) {
            left_out.add("file that is not DICOM");
            continue;
        }
        ++dicom_files;
        DicomHeader header = read_dicom_header(file);
        if (header.foreign.empty()) {
            slices.push_back(std::move(header));
        } else {
            left_out.add(header.foreign);
        }
    }
    if (slices.empty()) {
        refuse_dicom(place,
                     dicom_files == 0 ? fmt::format("there is no DICOM file, only {}",
                                                    left_out.empty() ? "empty folders" : left_out.text())
                                      : fmt::format("there is no CT slice, only {}", left_out.text()),
                     "the slices of one CT series",
                     dicom_files == 0 ? "give the folder that contains the slices"
                                      : "export the original CT; other images have no Hounsfield units");
    }
    const std::vector<DicomSeries> all = sort_by_series(std::move(slices), place);
    const DicomSeries& chosen = choose_series(all, wanted, place);
    if (chosen.fault && chosen.files.front().geometry.size[2] > 1) {
        refuse_dicom(chosen.fault->file, chosen.fault->found, chosen.fault->expected, chosen.fault->remedy);
    }
    left_out.add("image in another direction", chosen.in_other_directions);
    std::string others = left_out.text();
    for (const DicomSeries& series : all) {
        if (&series != &chosen) {
            others += fmt::format("{}series {}", others.empty() ? "" : ", ", series.label());
        }
    }
    std::vector<DicomFrames> frames;
    std::size_t voxels = 0;
    for (const DicomHeader& slice : chosen.files) {
        voxels += slice.geometry.count();
        if (voxels > max_voxels) {
            refuse_dicom(place, fmt::format("there are more than {} voxels", max_voxels), "fewer",
                         "give one series, cropped to head and neck");
        }
        frames.push_back(read_dicom_frames(slice.file));
    }
    if (!others.empty()) {
        remarks.push_back(fmt::format("{}: read series {}; left out {}", place, chosen.label(), others));
    }
    if (frames.size() == 1 && frames.front().geometry.size[2] > 1) {
        return {frames.front().geometry, std::move(frames.front().value)};
    }
    return stack(frames, place);
}

}  // namespace eti::imaging
