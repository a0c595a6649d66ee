// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <optional>

#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

constexpr std::size_t block = 512;

[[noreturn]] void refuse_project(const std::string& file, const std::string& found,
                                 const std::string& expected) {
    throw VolumeError(
        fmt::format("{}: InVesalius project: {}; expected {}. Remedy: save the project again with "
                    "InVesalius 3, or export the CT as NIfTI.",
                    file, found, expected));
}

/// The entry of a tar archive (POSIX ustar) whose name ends in `name`.
std::optional<std::span<const std::uint8_t>> entry(std::span<const std::uint8_t> tar,
                                                   const std::string& name) {
    for (std::size_t at = 0; at + block <= tar.size() && tar[at] != 0;) {
        const auto* text = reinterpret_cast<const char*>(tar.data() + at);
        const std::string path(text, ::strnlen(text, 100));
        std::size_t size = 0;
        for (std::size_t k = 124; k < 135 && text[k] >= '0' && text[k] <= '7'; ++k) {
            size = 8 * size + static_cast<std::size_t>(text[k] - '0');
        }
        if (size > tar.size() - at - block) {
            return std::nullopt;
        }
        if (path == name || path.ends_with("/" + name)) {
            return tar.subspan(at + block, size);
        }
        at += block + (size + block - 1) / block * block;
    }
    return std::nullopt;
}

/// Texts of the elements `<tag>...</tag>` that follow `<key>name</key>`, at most `count`.
std::vector<std::string> values(const std::string& plist, const std::string& name, const std::string& tag,
                                std::size_t count) {
    std::vector<std::string> found;
    std::size_t at = plist.find("<key>" + name + "</key>");
    while (at != std::string::npos && found.size() < count) {
        const std::size_t open = plist.find("<" + tag + ">", at);
        if (open == std::string::npos) {
            break;
        }
        const std::size_t from = open + tag.size() + 2;
        const std::size_t to = plist.find("</" + tag + ">", from);
        if (to == std::string::npos) {
            break;
        }
        found.push_back(plist.substr(from, to - from));
        at = to;
    }
    return found;
}

}  // namespace

Volume parse_inv3(std::span<const std::uint8_t> packed, const std::string& file) {
    Bytes unpacked;
    std::span<const std::uint8_t> tar = packed;
    if (is_gzip(packed)) {
        unpacked = gunzip(packed, std::size_t{2} << 30, file);
        tar = unpacked;
    }
    const auto main = entry(tar, "main.plist");
    if (!main) {
        refuse_project(file, "it contains no complete main.plist",
                       "a tar archive with main.plist and matrix.dat");
    }
    const std::string plist(main->begin(), main->end());
    const auto shape = values(plist, "shape", "integer", 3);   // slices, rows, columns
    const auto spacing = values(plist, "spacing", "real", 3);  // columns, rows, slices [mm]
    const auto type = values(plist, "dtype", "string", 1);
    const auto name = values(plist, "filename", "string", 1);
    if (shape.size() != 3 || spacing.size() != 3 || type.size() != 1 || name.size() != 1) {
        refuse_project(file, "main.plist lacks the matrix's shape, spacing, type or file", "these four");
    }
    if (type[0] != "int16") {
        refuse_project(file, fmt::format("the matrix is of type {}", type[0].substr(0, 20)), "int16");
    }
    Volume volume;
    for (std::size_t k = 0; k < 3; ++k) {
        double millimetres = 0.0;
        const std::string& size = shape[2 - k];
        const bool good =
            std::from_chars(size.data(), size.data() + size.size(), volume.geometry.size[k]).ec ==
                std::errc() &&
            std::from_chars(spacing[k].data(), spacing[k].data() + spacing[k].size(), millimetres).ec ==
                std::errc();
        if (!good) {
            refuse_project(file, "a size or a spacing in main.plist is not a number", "numbers");
        }
        const bool backwards = k == 1;  // rows run from back to nose, against LPS
        volume.geometry.step(static_cast<int>(k), static_cast<int>(k)) =
            (backwards ? -1e-3 : 1e-3) * millimetres;
    }
    require_valid(volume.geometry, file);
    const std::size_t bytes = 2 * volume.geometry.count();
    const auto matrix = entry(tar, name[0]);
    if (!matrix || matrix->size() < bytes) {
        refuse_project(file,
                       fmt::format("{} has {} bytes", name[0].substr(0, 60), matrix ? matrix->size() : 0),
                       fmt::format("{}", bytes));
    }
    volume.value = to_floats(matrix->first(bytes), Scalar::i16, false);
    return volume;
}

}  // namespace eti::imaging
