// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include "common/process/escaped.hpp"
#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

/// Image of one file: a slice, or several stacked frames.
struct Frames {
    std::string file;
    std::string series;
    Geometry geometry;  ///< third column: step between frames, zero for a single one
    std::vector<float> value;
};

[[noreturn]] void refuse_dicom(const std::string& file, const std::string& found, const std::string& expected,
                               const std::string& remedy) {
    throw VolumeError(fmt::format("{}: DICOM: {}; expected {}. Remedy: {}.", file, found, expected, remedy));
}

/// A DICOM file begins with a preamble of 128 bytes and "DICM" (PS3.10, 7.1).
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

Scalar dicom_scalar(const gdcm::PixelFormat& format, const std::string& file) {
    switch (format.GetScalarType()) {
        case gdcm::PixelFormat::UINT8:
            return Scalar::u8;
        case gdcm::PixelFormat::INT8:
            return Scalar::i8;
        case gdcm::PixelFormat::UINT12:
        case gdcm::PixelFormat::UINT16:
            return Scalar::u16;
        case gdcm::PixelFormat::INT12:
        case gdcm::PixelFormat::INT16:
            return Scalar::i16;
        case gdcm::PixelFormat::UINT32:
            return Scalar::u32;
        case gdcm::PixelFormat::INT32:
            return Scalar::i32;
        default:
            refuse_dicom(file, "the pixels are of an unusual type", "8, 16 or 32 bit integers",
                         "export the series as plain CT");
    }
}

/// Whether the file contains all announced pixels: GDCM pads missing ones. Encapsulated data must end with a
/// delimiter (PS3.5, 7.1 and A.4).
bool has_all_pixels(const std::filesystem::path& path) {
    const Bytes file = read_bytes(path);
    constexpr std::array<std::uint8_t, 4> tag = {0xe0, 0x7f, 0x10, 0x00};
    constexpr std::array<std::uint8_t, 8> delimiter = {0xfe, 0xff, 0xdd, 0xe0, 0, 0, 0, 0};
    for (auto at = file.begin();; ++at) {
        at = std::search(at, file.end(), tag.begin(), tag.end());
        if (file.end() - at < 12) {
            return false;
        }
        const std::uint8_t* value = &*at + 4;
        const bool explicit_type = value[0] == 'O' && (value[1] == 'W' || value[1] == 'B');
        value += explicit_type ? 4 : 0;
        const auto length = load<std::uint32_t>(value, false);
        const auto rest = static_cast<std::size_t>(file.data() + file.size() - value - 4);
        if (length == 0xffffffffu) {
            if (std::search(at, file.end(), delimiter.begin(), delimiter.end()) != file.end()) {
                return true;
            }
        } else if (length <= rest) {
            return true;
        }
    }
}

/// Numbers of a text, separated by backslashes (PS3.5, 6.2, DS); empty if one is malformed.
std::optional<std::vector<double>> numbers_of(const std::string& text) {
    std::vector<double> out;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('\\', at), text.size());
        const std::size_t first = std::min(text.find_first_not_of(" +", at), end);
        const std::size_t last = text.find_last_not_of(' ', end - 1) + 1;
        double number = 0.0;
        const auto [rest, error] = std::from_chars(text.data() + first, text.data() + end, number);
        if (first >= end || error != std::errc() || rest != text.data() + std::min(last, end) ||
            !std::isfinite(number)) {
            return std::nullopt;
        }
        out.push_back(number);
        at = end + 1;
    }
    return out;
}

/// Rejects spacing and directions that GDCM would silently replace by 1 mm and the axes. Multi-frame files
/// give both per frame.
void check_grid(const gdcm::DataSet& data, const std::string& file, bool one_frame) {
    const auto read = [&](const gdcm::Tag& tag) -> std::optional<std::vector<double>> {
        const std::string text = element_text(data, tag);
        if (text.empty() && !one_frame) {
            return std::nullopt;
        }
        const auto numbers = numbers_of(text);
        return numbers ? *numbers : std::vector<double>{};
    };
    const auto shown = [&](const gdcm::Tag& tag) {
        const std::string text = element_text(data, tag);
        return text.empty() ? "nothing" : fmt::format("'{}'", escaped(text, max_shown_bytes));
    };
    const gdcm::Tag spacing_tag(0x0028, 0x0030), directions_tag(0x0020, 0x0037);
    if (const auto s = read(spacing_tag); s && (s->size() != 2 || !((*s)[0] > 0.0) || !((*s)[1] > 0.0))) {
        refuse_dicom(file, "Pixel Spacing is " + shown(spacing_tag), "two numbers above 0 [mm]",
                     "export the original slices, with their spacing");
    }
    if (const auto d = read(directions_tag)) {
        bool good = d->size() == 6;
        if (good) {
            const Vec3d row((*d)[0], (*d)[1], (*d)[2]), column((*d)[3], (*d)[4], (*d)[5]);
            // Deviation from unit length and right angles by a scanner's rounding.
            constexpr double rounded = 0.01;
            good = std::abs(row.norm() - 1.0) < rounded && std::abs(column.norm() - 1.0) < rounded &&
                   std::abs(row.dot(column)) < rounded;
        }
        if (!good) {
            refuse_dicom(file, "Image Orientation (Patient) is " + shown(directions_tag),
                         "two orthogonal unit vectors", "export the original slices");
        }
    }
}

Frames read_file(const std::filesystem::path& path) {
    Frames frames;
    frames.file = path.string();
    gdcm::ImageReader reader;
    reader.SetFileName(path.c_str());
    if (!reader.Read()) {
        refuse_dicom(frames.file, "the file cannot be read as an image", "a whole CT slice",
                     "it is damaged or truncated, or not an image; copy or export the series again");
    }
    const gdcm::DataSet& data = reader.GetFile().GetDataSet();
    if (const std::string modality = element_text(data, gdcm::Tag(0x0008, 0x0060)); modality != "CT") {
        refuse_dicom(frames.file, fmt::format("the modality is '{}'", modality), "CT",
                     "use a CT; other images have no Hounsfield units");
    }
    frames.series = element_text(data, gdcm::Tag(0x0020, 0x000e));
    const gdcm::Image& image = reader.GetImage();
    if (image.GetPixelFormat().GetSamplesPerPixel() != 1) {
        refuse_dicom(frames.file, "the image is in colour", "one value per pixel", "export the CT itself");
    }
    Geometry& geometry = frames.geometry;
    check_grid(data, frames.file, image.GetNumberOfDimensions() < 3 || image.GetDimension(2) <= 1);
    const unsigned dimensions = image.GetNumberOfDimensions();
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned n = k < dimensions ? image.GetDimension(k) : 1;
        if (n < 1 || n > 100000) {
            refuse_dicom(frames.file, fmt::format("a size is {}", n), "1 to 100000",
                         "export the series again");
        }
        geometry.size[k] = static_cast<int>(n);
    }
    const double* origin = image.GetOrigin();
    const double* cosines = image.GetDirectionCosines();
    const double* spacing = image.GetSpacing();
    const bool placed = data.FindDataElement(gdcm::Tag(0x0020, 0x0032)) || geometry.size[2] > 1;
    if (!placed || origin == nullptr || cosines == nullptr || spacing == nullptr) {
        refuse_dicom(frames.file, "the slice has no position (Image Position Patient)", "one",
                     "export the original slices, not screen captures");
    }
    // Files round them; the spacing determines lengths.
    const Vec3d row = Vec3d(cosines[0], cosines[1], cosines[2]).normalized();
    const Vec3d column = Vec3d(cosines[3], cosines[4], cosines[5]).normalized();
    geometry.origin = 1e-3 * Vec3d(origin[0], origin[1], origin[2]);
    geometry.step.col(0) = 1e-3 * spacing[0] * row;
    geometry.step.col(1) = 1e-3 * spacing[1] * column;
    geometry.step.col(2) =
        geometry.size[2] > 1 ? Vec3d(1e-3 * spacing[2] * row.cross(column)) : Vec3d::Zero();
    if (geometry.count() > max_voxels) {
        refuse_dicom(frames.file, fmt::format("it has {} voxels", geometry.count()),
                     fmt::format("at most {}", max_voxels), "crop it to head and neck");
    }
    if (image.GetTransferSyntax() != gdcm::TransferSyntax::ExplicitVRBigEndian && !has_all_pixels(path)) {
        refuse_dicom(frames.file, "pixel data are incomplete", "a whole CT slice",
                     "the file is truncated; copy or export the series again");
    }
    const Scalar type = dicom_scalar(image.GetPixelFormat(), frames.file);
    const std::size_t bytes = geometry.count() * size_of(type);
    if (image.GetBufferLength() != bytes) {
        refuse_dicom(frames.file, fmt::format("there are {} bytes of pixels", image.GetBufferLength()),
                     fmt::format("{}", bytes), "the file is damaged; export the series again");
    }
    Bytes buffer(bytes);
    if (!image.GetBuffer(reinterpret_cast<char*>(buffer.data()))) {
        refuse_dicom(frames.file, "the pixels cannot be decoded", "whole pixel data",
                     "the file is damaged or truncated, or its compression is not supported by GDCM; export "
                     "the series uncompressed");
    }
    frames.value = to_floats(buffer, type, false);
    const auto slope = static_cast<float>(image.GetSlope());
    const auto intercept = static_cast<float>(image.GetIntercept());
    if (!std::isfinite(slope) || slope == 0.0f || !std::isfinite(intercept)) {
        refuse_dicom(frames.file,
                     fmt::format("Rescale Slope is {:g} and Rescale Intercept {:g}", slope, intercept),
                     "finite values that convert pixels to Hounsfield units", "export the original slices");
    }
    for (float& v : frames.value) {
        v = slope * v + intercept;
    }
    return frames;
}

/// Stacks the slices of one series.
Volume stack(std::vector<Frames>& slices, const std::string& folder) {
    const Geometry& first = slices.front().geometry;
    const Vec3d normal = first.step.col(0).cross(first.step.col(1)).normalized();
    std::sort(slices.begin(), slices.end(), [&](const Frames& a, const Frames& b) {
        return a.geometry.origin.dot(normal) < b.geometry.origin.dot(normal);
    });
    Volume volume;
    volume.geometry = slices.front().geometry;
    volume.geometry.size[2] = static_cast<int>(slices.size());
    const auto gap = [&](std::size_t i) -> Vec3d {
        return slices[i + 1].geometry.origin - slices[i].geometry.origin;
    };
    if (slices.size() > 1) {
        volume.geometry.step.col(2) = (slices.back().geometry.origin - slices.front().geometry.origin) /
                                      static_cast<double>(slices.size() - 1);
    }
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const Geometry& g = slices[i].geometry;
        if (g.size[0] != first.size[0] || g.size[1] != first.size[1] ||
            (g.step - first.step).norm() > 1e-3 * first.step.norm()) {
            refuse_dicom(slices[i].file, "size, spacing or direction differ from the series' first slice",
                         "the same", "export one series with one field of view");
        }
        const double usual = volume.geometry.step.col(2).norm();
        if (i + 1 < slices.size() && (gap(i) - volume.geometry.step.col(2)).norm() > 0.1 * usual) {
            refuse_dicom(folder,
                         fmt::format("between {} and {} the slices are {:.3f} mm apart, elsewhere {:.3f} mm",
                                     slices[i].file, slices[i + 1].file, 1e3 * gap(i).norm(), 1e3 * usual),
                         "equal distances", "a slice is missing or duplicated; export the series again");
        }
        volume.value.insert(volume.value.end(), slices[i].value.begin(), slices[i].value.end());
    }
    return volume;
}

}  // namespace

Volume read_dicom(const std::filesystem::path& folder, std::vector<std::string>& remarks) {
    gdcm::Trace::SetDebug(false);
    gdcm::Trace::SetWarning(false);
    gdcm::Trace::SetError(false);
    std::vector<std::filesystem::path> files;
    std::size_t others = 0;
    if (std::filesystem::is_directory(folder)) {
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            if (entry.is_regular_file() && is_dicom(entry.path())) {
                files.push_back(entry.path());
            } else {
                ++others;
            }
        }
    } else {
        files.push_back(folder);
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) {
        refuse_dicom(folder.string(), fmt::format("none of its {} entries is a DICOM file", others),
                     "the slices of one CT series", "give the folder that contains the slices");
    }
    std::map<std::string, std::vector<Frames>> series;
    std::size_t voxels = 0;
    for (const auto& file : files) {
        Frames frames = read_file(file);
        voxels += frames.geometry.count();
        if (voxels > max_voxels) {
            refuse_dicom(folder.string(), fmt::format("there are more than {} voxels", max_voxels), "fewer",
                         "give one series, cropped to head and neck");
        }
        series[frames.series].push_back(std::move(frames));
    }
    auto largest = series.begin();
    for (auto it = series.begin(); it != series.end(); ++it) {
        if (it->second.size() > largest->second.size()) {
            largest = it;
        }
    }
    for (const auto& [name, slices] : series) {
        if (name != largest->first) {
            remarks.push_back(fmt::format("{}: ignored series {} of {} files; used {} of {} files",
                                          folder.string(), name, slices.size(), largest->first,
                                          largest->second.size()));
        }
    }
    if (others > 0) {
        remarks.push_back(
            fmt::format("{}: ignored {} entries that are not DICOM files", folder.string(), others));
    }
    std::vector<Frames>& slices = largest->second;
    if (slices.size() == 1 && slices.front().geometry.size[2] > 1) {
        return {slices.front().geometry, std::move(slices.front().value)};
    }
    for (const Frames& slice : slices) {
        if (slice.geometry.size[2] != 1) {
            refuse_dicom(slice.file, "the series has a multi-frame file and other files",
                         "one multi-frame file or a folder of slices", "give the file itself");
        }
    }
    return stack(slices, folder.string());
}

}  // namespace eti::imaging
