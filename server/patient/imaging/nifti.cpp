// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <cmath>
#include <map>
#include <optional>

#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

constexpr std::size_t header_bytes = 348;
constexpr std::size_t data_begin = 352;  // after four bytes that announce extensions

// Offsets into the header (nifti1.h).
constexpr std::size_t at_dim = 40;
constexpr std::size_t at_datatype = 70;
constexpr std::size_t at_bits = 72;
constexpr std::size_t at_pixdim = 76;
constexpr std::size_t at_offset = 108;
constexpr std::size_t at_slope = 112;
constexpr std::size_t at_intercept = 116;
constexpr std::size_t at_units = 123;
constexpr std::size_t at_qform = 252;
constexpr std::size_t at_sform = 254;
constexpr std::size_t at_quaternion = 256;
constexpr std::size_t at_qoffset = 268;
constexpr std::size_t at_srow = 280;
constexpr std::size_t at_magic = 344;

[[noreturn]] void refuse_nifti(const std::string& file, const std::string& found, const std::string& expected,
                               const std::string& remedy) {
    throw VolumeError(fmt::format("{}: NIfTI: {}; expected {}. Remedy: {}.", file, found, expected, remedy));
}

const Vec3d from_ras(-1, -1, 1);

/// Directions and spacing [the file's unit, RAS], and the first voxel's position.
struct Axes {
    Eigen::Matrix3d step = Eigen::Matrix3d::Zero();
    Vec3d origin = Vec3d::Zero();
};

/// Position and directions: sform before qform, as nifti1.h advises. The file's space is RAS.
Geometry nifti_geometry(const std::uint8_t* header, bool swap, const std::string& file) {
    Geometry geometry;
    for (std::size_t k = 0; k < 3; ++k) {
        geometry.size[k] = load<std::int16_t>(header + at_dim + 2 * (k + 1), swap);
    }
    double unit = 1e-3;
    switch (header[at_units] & 7) {
        case 1:
            unit = 1.0;
            break;
        case 3:
            unit = 1e-6;
            break;
        default:
            break;
    }
    std::optional<Axes> sform, qform;
    if (load<std::int16_t>(header + at_sform, swap) > 0) {
        sform.emplace();
        for (int row = 0; row < 3; ++row) {
            const std::uint8_t* at = header + at_srow + 16 * static_cast<std::size_t>(row);
            for (int column = 0; column < 3; ++column) {
                sform->step(row, column) = load<float>(at + 4 * static_cast<std::size_t>(column), swap);
            }
            sform->origin[row] = load<float>(at + 12, swap);
        }
    }
    if (load<std::int16_t>(header + at_qform, swap) > 0) {
        qform.emplace();
        const double b = load<float>(header + at_quaternion, swap);
        const double c = load<float>(header + at_quaternion + 4, swap);
        const double d = load<float>(header + at_quaternion + 8, swap);
        const double a = std::sqrt(std::max(0.0, 1.0 - b * b - c * c - d * d));
        const double handed = load<float>(header + at_pixdim, swap) < 0.0f ? -1.0 : 1.0;
        qform->step = Eigen::Quaterniond(a, b, c, d).normalized().toRotationMatrix();
        for (int k = 0; k < 3; ++k) {
            const double spacing =
                load<float>(header + at_pixdim + 4 * static_cast<std::size_t>(k + 1), swap);
            qform->step.col(k) *= k == 2 ? handed * spacing : spacing;
            qform->origin[k] = load<float>(header + at_qoffset + 4 * static_cast<std::size_t>(k), swap);
        }
    }
    if (!sform && !qform) {
        refuse_nifti(file, "the header lacks the patient's directions (qform and sform codes are 0)",
                     "one of them", "export it with its orientation");
    }
    // Left and right cannot be told apart in the image itself.
    if (sform && qform && sform->step.determinant() * qform->step.determinant() < 0.0) {
        refuse_nifti(
            file, "sform and qform contradict each other: one is the mirror image of the other",
            "the same handedness of both",
            "find out which is right, and set the code of the other to 0 (fslorient -setqformcode 0 or "
            "-setsformcode 0; nibabel: set_qform(None) or set_sform(None))");
    }
    const Axes& axes = sform ? *sform : *qform;
    geometry.origin = unit * from_ras.cwiseProduct(axes.origin);
    geometry.step = unit * from_ras.asDiagonal() * axes.step;
    return geometry;
}

}  // namespace

Volume parse_nifti(std::span<const std::uint8_t> packed, const std::string& file,
                   std::vector<std::string>* remarks) {
    Bytes unpacked;
    std::span<const std::uint8_t> data = packed;
    const bool compressed = is_gzip(packed);
    if (compressed) {
        unpacked = gunzip(packed, header_bytes, file);
        data = unpacked;
    }
    if (data.size() < header_bytes) {
        refuse_nifti(file, fmt::format("the file has {} bytes", data.size()), "a header of 348 bytes",
                     "the file is truncated; copy or export it again");
    }
    const std::uint8_t* header = data.data();
    const auto stated = load<std::int32_t>(header, false);
    const bool swap = stated != static_cast<std::int32_t>(header_bytes);
    if (swap && load<std::int32_t>(header, true) != static_cast<std::int32_t>(header_bytes)) {
        refuse_nifti(file, fmt::format("the header begins with {}", stated), "348, its length",
                     "save it as NIfTI-1 (.nii or .nii.gz)");
    }
    const std::string magic(header + at_magic, header + at_magic + 3);
    if (magic != "n+1") {
        refuse_nifti(file, "header and voxels are in two files", "both in one",
                     "save it as .nii or .nii.gz, not as .hdr and .img");
    }
    const int dimensions = load<std::int16_t>(header + at_dim, swap);
    bool one = dimensions >= 3 && dimensions <= 7;
    for (int k = 4; one && k <= dimensions; ++k) {
        one = load<std::int16_t>(header + at_dim + 2 * static_cast<std::size_t>(k), swap) == 1;
    }
    if (!one) {
        refuse_nifti(file, fmt::format("the image has {} dimensions", dimensions), "one volume of three",
                     "export a single volume");
    }
    Volume volume;
    volume.geometry = nifti_geometry(header, swap, file);
    require_valid(volume.geometry, file);
    static const std::map<int, Scalar> types = {
        {2, Scalar::u8},   {4, Scalar::i16},   {8, Scalar::i32},   {16, Scalar::f32},   {64, Scalar::f64},
        {256, Scalar::i8}, {512, Scalar::u16}, {768, Scalar::u32}, {1024, Scalar::i64}, {1280, Scalar::u64}};
    const int code = load<std::int16_t>(header + at_datatype, swap);
    const auto type = types.find(code);
    if (type == types.end()) {
        refuse_nifti(file, fmt::format("the data type is {}", code), "a scalar type",
                     "export one scalar volume");
    }
    const double stated_offset = load<float>(header + at_offset, swap);
    // 0 in a single file stands for "after the header", as nibabel reads it.
    const double offset = stated_offset == 0.0 ? static_cast<double>(data_begin) : stated_offset;
    if (!(offset >= static_cast<double>(data_begin) && offset < 1e8)) {
        refuse_nifti(file, fmt::format("the voxels begin at byte {}", offset), "352 or later",
                     "the header is damaged; export it again");
    }
    const auto begin = static_cast<std::size_t>(offset);
    const std::size_t bytes = volume.geometry.count() * size_of(type->second);
    Bytes all;
    if (compressed) {
        all = gunzip(packed, begin + bytes, file);
        data = all;
    }
    if (data.size() < begin + bytes) {
        refuse_nifti(file,
                     fmt::format("there are {} bytes of voxels", data.size() - std::min(begin, data.size())),
                     fmt::format("{}", bytes), "the file is truncated; copy or export it again");
    }
    volume.value = to_floats(data.subspan(begin, bytes), type->second, swap);
    const float slope = load<float>(data.data() + at_slope, swap);
    const float intercept = load<float>(data.data() + at_intercept, swap);
    if (!std::isfinite(slope)) {
        // nibabel writes an undefined scale as NaN.
        if (remarks != nullptr) {
            remarks->push_back(
                fmt::format("{}: NIfTI: scl_slope is {}; the values are taken as stored. If they are not "
                            "Hounsfield units, "
                            "export the file again with its scale",
                            file, slope));
        }
    } else if (slope != 0.0f) {  // 0: unscaled values (nifti1.h)
        if (!std::isfinite(intercept)) {
            refuse_nifti(file, fmt::format("scl_inter is {}", intercept), "a finite value",
                         "export it again with its scale");
        }
        for (float& v : volume.value) {
            v = slope * v + intercept;
        }
    }
    return volume;
}

Bytes encode_nifti(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data) {
    Bytes header(data_begin, 0);
    const auto put = [&](std::size_t at, auto value) {
        std::memcpy(header.data() + at, &value, sizeof(value));
    };
    put(0, static_cast<std::int32_t>(header_bytes));
    put(at_dim, std::int16_t{3});
    for (std::size_t k = 0; k < 3; ++k) {
        put(at_dim + 2 * (k + 1), static_cast<std::int16_t>(geometry.size[k]));
        put(at_pixdim + 4 * (k + 1), static_cast<float>(1e3 * geometry.spacing()[static_cast<int>(k)]));
    }
    for (std::size_t k = 4; k < 8; ++k) {
        put(at_dim + 2 * k, std::int16_t{1});
    }
    put(at_datatype, static_cast<std::int16_t>(type == Scalar::u8 ? 2 : 4));
    put(at_bits, static_cast<std::int16_t>(8 * size_of(type)));
    put(at_offset, static_cast<float>(data_begin));
    put(at_slope, 1.0f);
    header[at_units] = 2;  // mm
    put(at_sform, std::int16_t{1});
    for (int row = 0; row < 3; ++row) {
        const std::size_t at = at_srow + 16 * static_cast<std::size_t>(row);
        for (int column = 0; column < 3; ++column) {
            put(at + 4 * static_cast<std::size_t>(column),
                static_cast<float>(1e3 * from_ras[row] * geometry.step(row, column)));
        }
        put(at + 12, static_cast<float>(1e3 * from_ras[row] * geometry.origin[row]));
    }
    std::memcpy(header.data() + at_magic, "n+1", 4);
    header.insert(header.end(), data.begin(), data.end());
    return header;
}

}  // namespace eti::imaging
