// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/dicom/header.hpp"

#include <gdcmAttribute.h>
#include <gdcmReader.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <fstream>

#include "common/process/escaped.hpp"
#include "server/patient/imaging/dicom/numbers.hpp"

namespace eti::imaging {

namespace {

constexpr const char* media_directory = "1.2.840.10008.1.3.10";
constexpr const char* dose_report = "1.2.840.10008.5.1.4.1.1.88.67";
constexpr const char* secondary_capture = "1.2.840.10008.5.1.4.1.1.7";  // and multi-frame ones, ".1" to ".4"

/// A whole number such as Rows; 0 if it is absent.
template <std::uint16_t Group, std::uint16_t Member>
int whole_number(const gdcm::DataSet& data) {
    gdcm::Attribute<Group, Member> value;
    const gdcm::Tag tag(Group, Member);
    if (!data.FindDataElement(tag) || data.GetDataElement(tag).IsEmpty()) {
        return 0;
    }
    value.SetFromDataElement(data.GetDataElement(tag));
    return static_cast<int>(value.GetValue());
}

/// The value of Image Type at a place (PS3.3, C.7.6.1.1.2), counted from 0.
std::string image_type(const gdcm::DataSet& data, int place) {
    std::string text = element_text(data, gdcm::Tag(0x0008, 0x0008));
    for (; place > 0; --place) {
        const std::size_t end = text.find('\\');
        text = end == std::string::npos ? std::string() : text.substr(end + 1);
    }
    return text.substr(0, text.find('\\'));
}

std::string reason_to_leave_out(const gdcm::DataSet& data, const std::string& sop_class,
                                const Geometry& geometry) {
    if (sop_class == media_directory) {
        return "DICOMDIR";
    }
    const std::string modality = element_text(data, gdcm::Tag(0x0008, 0x0060));
    if (sop_class == dose_report) {
        return "dose report";
    }
    const bool pixels = data.FindDataElement(gdcm::Tag(0x7fe0, 0x0010));
    if (modality != "CT") {
        return fmt::format("{} {}", modality.empty() ? "unnamed" : escaped(modality, 16),
                           pixels ? "image" : "object without pixels");
    }
    if (!pixels || geometry.count() == 0) {
        return "object without pixels";
    }
    if (sop_class == secondary_capture || sop_class.starts_with(std::string(secondary_capture) + ".")) {
        return "screen capture";
    }
    if (image_type(data, 2) == "LOCALIZER") {
        return "scout image";
    }
    // Dose reports and protocols drawn as images.
    if (geometry.size[2] == 1 && !data.FindDataElement(gdcm::Tag(0x0020, 0x0032)) &&
        image_type(data, 1) == "SECONDARY") {
        return "screen capture";
    }
    return "";
}

}  // namespace

void refuse_dicom(const std::string& file, const std::string& found, const std::string& expected,
                  const std::string& remedy) {
    throw VolumeError(fmt::format("{}: DICOM: {}; expected {}. Remedy: {}.", file, found, expected, remedy));
}

bool is_dicom(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::array<char, 132> head{};
    in.read(head.data(), head.size());
    return in && std::string_view(head.data() + 128, 4) == "DICM";
}

std::string element_text(const gdcm::DataSet& data, const gdcm::Tag& tag) {
    if (!data.FindDataElement(tag)) {
        return {};
    }
    const gdcm::ByteValue* value = data.GetDataElement(tag).GetByteValue();
    if (value == nullptr || value->GetLength() > 256) {
        return {};
    }
    std::string text(value->GetPointer(), value->GetLength());
    text.erase(std::find_if(text.rbegin(), text.rend(), [](char c) { return c != ' ' && c != '\0'; }).base(),
               text.end());
    return text;
}

DicomHeader read_dicom_header(const std::filesystem::path& file) {
    DicomHeader header;
    header.file = file.string();
    gdcm::Reader reader;
    reader.SetFileName(file.c_str());
    if (!reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0010))) {
        refuse_dicom(header.file, "the file cannot be read as an image", "a whole CT slice",
                     "it is damaged or truncated, or not an image; copy or export the series again, or "
                     "remove the file if it is not part of the series");
    }
    const gdcm::DataSet& data = reader.GetFile().GetDataSet();
    header.series = element_text(data, gdcm::Tag(0x0020, 0x000e));
    header.description = element_text(data, gdcm::Tag(0x0008, 0x103e));
    Geometry& geometry = header.geometry;
    geometry.size[0] = whole_number<0x0028, 0x0011>(data);
    geometry.size[1] = whole_number<0x0028, 0x0010>(data);
    const auto frames = numbers_of(element_text(data, gdcm::Tag(0x0028, 0x0008)));
    geometry.size[2] =
        frames && frames->size() == 1 ? static_cast<int>(std::clamp((*frames)[0], 0.0, 1e6)) : 1;
    header.foreign = reason_to_leave_out(
        data, element_text(reader.GetFile().GetHeader(), gdcm::Tag(0x0002, 0x0002)), geometry);
    geometry.step.setZero();
    const auto position = numbers_of(element_text(data, gdcm::Tag(0x0020, 0x0032)));
    const auto spacing = numbers_of(element_text(data, gdcm::Tag(0x0028, 0x0030)));
    const auto directions = numbers_of(element_text(data, gdcm::Tag(0x0020, 0x0037)));
    if (position && position->size() == 3) {
        geometry.origin = 1e-3 * Eigen::Map<const Vec3d>(position->data());
    }
    if (spacing && spacing->size() == 2 && directions && directions->size() == 6) {
        // Pixel Spacing: distance of rows, then of columns (PS3.3, 10.7.1.3).
        geometry.step.col(0) = 1e-3 * (*spacing)[1] * Eigen::Map<const Vec3d>(directions->data());
        geometry.step.col(1) = 1e-3 * (*spacing)[0] * Eigen::Map<const Vec3d>(directions->data() + 3);
    }
    return header;
}

}  // namespace eti::imaging
