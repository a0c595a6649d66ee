// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/dicom/slice.hpp"

#include <gdcmImageReader.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/process/escaped.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/dicom/numbers.hpp"

namespace eti::imaging {

namespace {

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

/// Refuses a file that does not contain all announced pixels, as GDCM pads missing ones. Encapsulated data
/// must end with a delimiter (PS3.5, 7.1 and A.4).
void require_all_pixels(const std::filesystem::path& path, bool big_endian) {
    const Bytes file = read_bytes(path);
    const std::array<std::uint8_t, 4> tag = big_endian ? std::array<std::uint8_t, 4>{0x7f, 0xe0, 0x00, 0x10}
                                                       : std::array<std::uint8_t, 4>{0xe0, 0x7f, 0x10, 0x00};
    constexpr std::array<std::uint8_t, 8> delimiter = {0xfe, 0xff, 0xdd, 0xe0, 0, 0, 0, 0};
    bool undelimited = false;
    for (auto at = file.begin();; ++at) {
        at = std::search(at, file.end(), tag.begin(), tag.end());
        if (file.end() - at < 12) {
            break;
        }
        const std::uint8_t* value = &*at + 4;
        const bool explicit_type = value[0] == 'O' && (value[1] == 'W' || value[1] == 'B');
        value += explicit_type ? 4 : 0;
        const auto length = load<std::uint32_t>(value, big_endian);
        const auto rest = static_cast<std::size_t>(file.data() + file.size() - value - 4);
        if (length == 0xffffffffu) {
            if (std::search(at, file.end(), delimiter.begin(), delimiter.end()) != file.end()) {
                return;
            }
            undelimited = true;
        } else if (length <= rest) {
            return;
        }
    }
    if (undelimited) {
        refuse_dicom(path.string(), "the compressed pixel data do not end with a sequence delimiter", "one",
                     "the file is truncated, and must be copied again, or the program that wrote it left the "
                     "delimiter out: export the series uncompressed");
    }
    refuse_dicom(path.string(), "pixel data are incomplete", "a whole CT slice",
                 "the file is truncated; copy or export the series again");
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

}  // namespace

DicomFrames read_dicom_frames(const std::filesystem::path& path) {
    DicomFrames frames;
    frames.file = path.string();
    gdcm::ImageReader reader;
    reader.SetFileName(path.c_str());
    if (!reader.Read()) {
        refuse_dicom(frames.file, "the file cannot be read as an image", "a whole CT slice",
                     "it is damaged or truncated, or not an image; copy or export the series again");
    }
    const gdcm::DataSet& data = reader.GetFile().GetDataSet();
    if (reader.GetFile().GetHeader().GetDataSetTransferSyntax() ==
        gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian) {
        refuse_dicom(frames.file, "the file is deflated as a whole (transfer syntax 1.2.840.10008.1.2.1.99)",
                     "pixels that are uncompressed or compressed as an image",
                     "export the series uncompressed, or convert each file with gdcmconv --raw");
    }
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
    require_all_pixels(path, image.GetTransferSyntax() == gdcm::TransferSyntax::ExplicitVRBigEndian);
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

}  // namespace eti::imaging
