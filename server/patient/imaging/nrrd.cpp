// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/math/units.hpp"
#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

/// Fields of a header, and the offset of the data.
class Header {
  public:
    Header(std::span<const std::uint8_t> data, const std::string& file) : file_(file) {
        constexpr std::size_t longest = 1 << 20;
        std::size_t begin = 0;
        for (int line = 1;; ++line) {
            const auto from = data.begin() + static_cast<std::ptrdiff_t>(begin);
            const auto end = std::find(from, data.end(), std::uint8_t{'\n'});
            if (end == data.end() || begin > longest) {
                refuse("the header has no end", "an empty line after it",
                       "copy the file again; a detached header (.nhdr) is not supported");
            }
            std::string text(from, end);
            begin += text.size() + 1;
            if (!text.empty() && text.back() == '\r') {
                text.pop_back();
            }
            if (text.empty()) {
                break;
            }
            if (line == 1 || text[0] == '#') {
                continue;
            }
            const std::size_t colon = text.find(':');
            if (colon == std::string::npos) {
                refuse(fmt::format("line {} is '{}'", line, text.substr(0, 60)), "'field: value'",
                       "correct the header");
            }
            if (text.compare(colon, 2, ":=") == 0) {
                pairs_[text.substr(0, colon)] = text.substr(colon + 2);
                continue;
            }
            std::string value = text.substr(colon + 1);
            value.erase(0, value.find_first_not_of(" \t"));
            value.erase(value.find_last_not_of(" \t") + 1);
            fields_[text.substr(0, colon)] = value;
        }
        begin_ = begin;
    }

    [[noreturn]] void refuse(const std::string& found, const std::string& expected,
                             const std::string& remedy) const {
        throw VolumeError(
            fmt::format("{}: NRRD: {}; expected {}. Remedy: {}.", file_, found, expected, remedy));
    }

    [[nodiscard]] std::optional<std::string> find(const std::string& field) const {
        const auto it = fields_.find(field);
        return it == fields_.end() ? std::nullopt : std::optional(it->second);
    }

    /// The value of a key/value pair, which is free text.
    [[nodiscard]] std::optional<std::string> pair(const std::string& key) const {
        const auto it = pairs_.find(key);
        return it == pairs_.end() ? std::nullopt : std::optional(it->second);
    }

    [[nodiscard]] std::string need(const std::string& field, const std::string& expected) const {
        const auto value = find(field);
        if (!value) {
            refuse(fmt::format("there is no field '{}'", field), expected, "write the file with this field");
        }
        return *value;
    }

    /// The numbers in a field, separated by any brackets and commas.
    [[nodiscard]] std::vector<double> numbers(const std::string& field, const std::string& text,
                                              std::size_t count) const {
        std::vector<double> found;
        const char* at = text.data();
        const char* const end = at + text.size();
        while (at < end) {
            if (std::string_view(" \t(),").find(*at) != std::string_view::npos) {
                ++at;
                continue;
            }
            double value = 0.0;
            const auto [next, error] = std::from_chars(at, end, value);
            if (error != std::errc() || next == at) {
                refuse(fmt::format("field '{}' is '{}'", field, text.substr(0, 60)),
                       fmt::format("{} numbers", count), "correct the header");
            }
            found.push_back(value);
            at = next;
        }
        if (found.size() != count) {
            refuse(fmt::format("field '{}' has {} numbers", field, found.size()), fmt::format("{}", count),
                   "export one scalar volume (dimension 3)");
        }
        return found;
    }

    [[nodiscard]] std::size_t begin() const { return begin_; }

  private:
    std::string file_;
    std::map<std::string, std::string> fields_, pairs_;
    std::size_t begin_ = 0;
};

Scalar nrrd_scalar(const Header& header) {
    static const std::vector<std::pair<Scalar, std::vector<std::string_view>>> types = {
        {Scalar::i8, {"signed char", "int8", "int8_t"}},
        {Scalar::u8, {"uchar", "unsigned char", "uint8", "uint8_t"}},
        {Scalar::i16, {"short", "short int", "signed short", "int16", "int16_t"}},
        {Scalar::u16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
        {Scalar::i32, {"int", "signed int", "int32", "int32_t"}},
        {Scalar::u32, {"uint", "unsigned int", "uint32", "uint32_t"}},
        {Scalar::i64, {"longlong", "int64", "int64_t"}},
        {Scalar::u64, {"ulonglong", "uint64", "uint64_t"}},
        {Scalar::f32, {"float"}},
        {Scalar::f64, {"double"}},
    };
    const std::string name = header.need("type", "a scalar type such as 'short'");
    for (const auto& [type, names] : types) {
        if (std::ranges::find(names, name) != names.end()) {
            return type;
        }
    }
    header.refuse(fmt::format("the type is '{}'", name.substr(0, 60)), "a scalar type such as 'short'",
                  "export CT in Hounsfield units or labels");
}

/// Signs that map the file's space to LPS.
Vec3d signs_of(const Header& header) {
    const std::string space = header.need("space", "'left-posterior-superior'");
    if (space == "left-posterior-superior" || space == "LPS") {
        return {1, 1, 1};
    }
    if (space == "right-anterior-superior" || space == "RAS") {
        return {-1, -1, 1};
    }
    if (space == "left-anterior-superior" || space == "LAS") {
        return {1, -1, 1};
    }
    header.refuse(fmt::format("the space is '{}'", space.substr(0, 60)),
                  "left-posterior-superior, right-anterior-superior or left-anterior-superior",
                  "export it with the patient's directions");
}

Geometry nrrd_geometry(const Header& header) {
    Geometry geometry;
    const std::vector<double> sizes = header.numbers("sizes", header.need("sizes", "three sizes"), 3);
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(sizes[k] >= 1.0 && sizes[k] < 1e6) || sizes[k] != std::floor(sizes[k])) {
            header.refuse(fmt::format("a size is {}", sizes[k]), "a whole number from 4 to 100000",
                          "correct the header");
        }
        geometry.size[k] = static_cast<int>(sizes[k]);
    }
    const Vec3d signs = signs_of(header);
    const std::vector<double> directions =
        header.numbers("space directions", header.need("space directions", "the direction of each axis"), 9);
    const std::vector<double> origin =
        header.numbers("space origin", header.need("space origin", "the first voxel's position"), 3);
    double unit = 1e-3;
    if (const auto units = header.find("space units"); units && units->find("\"m\"") != std::string::npos) {
        unit = 1.0;
    }
    for (int row = 0; row < 3; ++row) {
        geometry.origin[row] = unit * signs[row] * origin[static_cast<std::size_t>(row)];
        for (int column = 0; column < 3; ++column) {
            geometry.step(row, column) =
                unit * signs[row] * directions[static_cast<std::size_t>(3 * column + row)];
        }
    }
    return geometry;
}

}  // namespace

Volume parse_nrrd(std::span<const std::uint8_t> data, const std::string& file) {
    const Header header(data, file);
    if (const auto detached = header.find("data file"); detached || header.find("datafile")) {
        header.refuse("the data are in another file", "header and data in one file",
                      "save it as .nrrd, not as .nhdr");
    }
    for (const char* skip : {"line skip", "lineskip", "byte skip", "byteskip"}) {
        if (const auto value = header.find(skip); value && *value != "0") {
            header.refuse(fmt::format("field '{}' is {}", skip, value->substr(0, 20)), "0",
                          "save it without this field");
        }
    }
    Volume volume;
    volume.geometry = nrrd_geometry(header);
    require_valid(volume.geometry, file);
    const Scalar type = nrrd_scalar(header);
    bool swap = false;
    if (size_of(type) > 1) {
        const std::string endian = header.need("endian", "'little' or 'big'");
        if (endian != "little" && endian != "big") {
            header.refuse(fmt::format("the field 'endian' is '{}'", endian.substr(0, 20)),
                          "'little' or 'big'", "correct the header");
        }
        swap = endian == "big";
    }
    const std::size_t bytes = volume.geometry.count() * size_of(type);
    const std::string encoding = header.need("encoding", "'raw' or 'gzip'");
    auto body = data.subspan(header.begin());
    Bytes unpacked;
    if (encoding == "gzip" || encoding == "gz") {
        unpacked = gunzip(body, bytes, file);
        body = unpacked;
    } else if (encoding != "raw") {
        header.refuse(fmt::format("the encoding is '{}'", encoding.substr(0, 20)), "'raw' or 'gzip'",
                      "save it compressed with gzip or not at all");
    }
    if (body.size() < bytes) {
        header.refuse(fmt::format("there are {} bytes of voxels", body.size()), fmt::format("{}", bytes),
                      "the file is truncated; copy or export it again");
    }
    volume.value = to_floats(body.first(bytes), type, swap);
    return volume;
}

std::map<int, std::string> parse_segment_names(std::span<const std::uint8_t> data, const std::string& file) {
    const Header header(data, file);
    std::map<int, std::string> names;
    for (int i = 0; i < 256; ++i) {
        const auto name = header.pair(fmt::format("Segment{}_Name", i));
        const auto value = header.pair(fmt::format("Segment{}_LabelValue", i));
        if (!name && !value) {
            break;
        }
        int label = i + 1;  // Slicer 4.10 and older: the number of the segment
        if (value) {
            const auto [end, error] = std::from_chars(value->data(), value->data() + value->size(), label);
            if (error != std::errc() || label < 0 || label > 65535) {
                header.refuse(fmt::format("Segment{}_LabelValue is '{}'", i, value->substr(0, 20)),
                              "a number from 0 to 65535", "save the segmentation again");
            }
        }
        names[label] = name.value_or("");
    }
    return names;
}

Bytes encode_nrrd(const Geometry& geometry, Scalar type, std::span<const std::uint8_t> data) {
    const auto vector = [](const Vec3d& v) {
        return fmt::format("({:.9g},{:.9g},{:.9g})", v.x() * 1e3, v.y() * 1e3, v.z() * 1e3);
    };
    std::string header = fmt::format(
        "NRRD0004\n# https://teem.sourceforge.net/nrrd/format.html\ntype: {}\ndimension: 3\n"
        "space: left-posterior-superior\nsizes: {} {} {}\nspace directions: {} {} {}\n"
        "kinds: domain domain domain\n{}encoding: gzip\nspace units: \"mm\" \"mm\" \"mm\"\n"
        "space origin: {}\n\n",
        type == Scalar::u8 ? "uchar" : "short", geometry.size[0], geometry.size[1], geometry.size[2],
        vector(geometry.step.col(0)), vector(geometry.step.col(1)), vector(geometry.step.col(2)),
        type == Scalar::u8 ? "" : "endian: little\n", vector(geometry.origin));
    Bytes out(header.begin(), header.end());
    const Bytes packed = gzip(data);
    out.insert(out.end(), packed.begin(), packed.end());
    return out;
}

}  // namespace eti::imaging
