// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/patient/imaging/read.hpp"

namespace eti::imaging {

namespace {

constexpr std::size_t max_triangles = 20'000'000;
constexpr float millimetre = 1e-3f;
constexpr float farthest = 1e5f;  // [mm]; no part of a patient is farther from the scanner's centre

[[noreturn]] void refuse_mesh(const std::string& name, const std::string& finding,
                              const std::string& expected) {
    throw VolumeError(
        fmt::format("{}: {}; expected {}. Remedy: export the surface again as binary STL, in millimetres.",
                    name, finding, expected));
}

/// Collects triangles and merges coincident corners.
class MeshBuilder {
  public:
    explicit MeshBuilder(const std::string& name) : name_(name) {}
    std::uint32_t vertex(const Vec3f& p) {
        if (!p.allFinite() || p.cwiseAbs().maxCoeff() > farthest) {
            refuse_mesh(name_, fmt::format("vertex {} is not within a patient", mesh_.vertices.size()),
                        "coordinates in millimetres");
        }
        const auto [it, fresh] =
            known_.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (fresh) {
            mesh_.vertices.push_back(millimetre * p);
        }
        return it->second;
    }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (a == b || b == c || c == a) {
            return;  // degenerate after merging
        }
        if (mesh_.triangles.size() >= max_triangles) {
            refuse_mesh(name_, fmt::format("more than {} triangles", max_triangles), "a smaller surface");
        }
        mesh_.triangles.push_back({a, b, c});
    }
    void polygon(const std::vector<std::uint32_t>& corners) {
        for (std::size_t k = 2; k < corners.size(); ++k) {
            triangle(corners[0], corners[k - 1], corners[k]);
        }
    }
    TriangleMesh finish(bool ras) {
        if (mesh_.triangles.empty()) {
            refuse_mesh(name_, "there are no triangles", "a surface");
        }
        if (ras) {
            for (Vec3f& v : mesh_.vertices) {
                v = Vec3f(-v.x(), -v.y(), v.z());
            }
        }
        return std::move(mesh_);
    }

  private:
    const std::string& name_;
    std::map<std::array<float, 3>, std::uint32_t> known_;
    TriangleMesh mesh_;
};

/// Splits a text into words, with line numbers.
class TokenReader {
  public:
    TokenReader(std::string_view text, const std::string& name) : rest_(text), name_(name) {}
    /// Reads the next line's words; returns false at the end.
    bool line(std::vector<std::string_view>& words) {
        words.clear();
        if (rest_.empty()) {
            return false;
        }
        ++number_;
        const std::size_t end = std::min(rest_.find('\n'), rest_.size());
        std::string_view text = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        while (true) {
            const std::size_t begin = text.find_first_not_of(" \t\r\f\v");
            if (begin == std::string_view::npos) {
                return true;
            }
            text.remove_prefix(begin);
            const std::size_t length = std::min(text.find_first_of(" \t\r\f\v"), text.size());
            words.push_back(text.substr(0, length));
            text.remove_prefix(length);
        }
    }
    [[nodiscard]] std::string_view rest() const { return rest_; }
    template <class T>
    [[nodiscard]] T number(std::string_view word) const {
        T value{};
        if (word.starts_with('+')) {
            word.remove_prefix(1);
        }
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            refuse_mesh(name_, fmt::format("line {}: '{}'", number_, word.substr(0, 40)), "a number");
        }
        return value;
    }
    [[nodiscard]] Vec3f point(const std::vector<std::string_view>& words, std::size_t at) const {
        if (words.size() < at + 3) {
            refuse_mesh(name_, fmt::format("line {}: {} words", number_, words.size()), "three coordinates");
        }
        return {number<float>(words[at]), number<float>(words[at + 1]), number<float>(words[at + 2])};
    }
    [[nodiscard]] std::size_t number_of_line() const { return number_; }

  private:
    std::string_view rest_;
    const std::string& name_;
    std::size_t number_ = 0;
};

std::string_view text_of(std::span<const std::uint8_t> data) {
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}

TriangleMesh parse_stl(std::span<const std::uint8_t> data, const std::string& name) {
    constexpr std::size_t head = 84;
    constexpr std::size_t each = 50;
    MeshBuilder gather(name);
    // Binary files may begin with "solid", too: their length is decisive.
    if (data.size() >= head) {
        const auto count = static_cast<std::size_t>(load<std::uint32_t>(data.data() + 80, false));
        if (data.size() == head + each * count) {
            for (std::size_t t = 0; t < count; ++t) {
                const std::uint8_t* at = data.data() + head + each * t + 12;
                std::array<std::uint32_t, 3> corner{};
                for (std::size_t k = 0; k < 3; ++k) {
                    corner[k] =
                        gather.vertex({load<float>(at + 12 * k, false), load<float>(at + 12 * k + 4, false),
                                       load<float>(at + 12 * k + 8, false)});
                }
                gather.triangle(corner[0], corner[1], corner[2]);
            }
            return gather.finish(text_of(data.first(80)).find("SPACE=RAS") != std::string_view::npos);
        }
        if (!text_of(data).starts_with("solid")) {
            refuse_mesh(name, fmt::format("{} bytes for {} triangles", data.size(), count),
                        fmt::format("{} bytes", head + each * count));
        }
    }
    TokenReader words(text_of(data), name);
    std::vector<std::string_view> line;
    std::vector<std::uint32_t> corners;
    while (words.line(line)) {
        if (line.empty()) {
            continue;
        }
        if (line[0] == "vertex") {
            corners.push_back(gather.vertex(words.point(line, 1)));
        } else if (line[0] == "endloop") {
            if (corners.size() != 3) {
                refuse_mesh(
                    name,
                    fmt::format("line {}: a facet of {} corners", words.number_of_line(), corners.size()),
                    "three");
            }
            gather.polygon(corners);
            corners.clear();
        }
    }
    return gather.finish(text_of(data).substr(0, 200).find("SPACE=RAS") != std::string_view::npos);
}

TriangleMesh parse_obj(std::span<const std::uint8_t> data, const std::string& name) {
    MeshBuilder gather(name);
    TokenReader words(text_of(data), name);
    std::vector<std::string_view> line;
    std::vector<std::uint32_t> vertices, corners;
    while (words.line(line)) {
        if (line.empty()) {
            continue;
        }
        if (line[0] == "v") {
            vertices.push_back(gather.vertex(words.point(line, 1)));
        } else if (line[0] == "f") {
            corners.clear();
            for (std::size_t k = 1; k < line.size(); ++k) {
                const auto index = words.number<long>(line[k].substr(0, line[k].find('/')));
                const long at = index > 0 ? index - 1 : static_cast<long>(vertices.size()) + index;
                if (at < 0 || at >= static_cast<long>(vertices.size())) {
                    refuse_mesh(name, fmt::format("line {}: vertex {}", words.number_of_line(), index),
                                fmt::format("1 to {}", vertices.size()));
                }
                corners.push_back(vertices[static_cast<std::size_t>(at)]);
            }
            gather.polygon(corners);
        }
    }
    return gather.finish(text_of(data).substr(0, 4000).find("SPACE=RAS") != std::string_view::npos);
}

/// One property of a PLY element.
struct Property {
    Scalar type = Scalar::f32;
    bool list = false;
    Scalar count = Scalar::u8;
    std::string name;
};
struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

Scalar scalar_named(std::string_view word, const std::string& name) {
    static const std::map<std::string_view, Scalar> names = {
        {"char", Scalar::i8},   {"int8", Scalar::i8},     {"uchar", Scalar::u8},   {"uint8", Scalar::u8},
        {"short", Scalar::i16}, {"int16", Scalar::i16},   {"ushort", Scalar::u16}, {"uint16", Scalar::u16},
        {"int", Scalar::i32},   {"int32", Scalar::i32},   {"uint", Scalar::u32},   {"uint32", Scalar::u32},
        {"float", Scalar::f32}, {"float32", Scalar::f32}, {"double", Scalar::f64}, {"float64", Scalar::f64}};
    const auto it = names.find(word);
    if (it == names.end()) {
        refuse_mesh(name, fmt::format("a property of type '{}'", word.substr(0, 40)), "a PLY type");
    }
    return it->second;
}

/// Sequential values of a PLY body, text or binary.
class PlyValueReader {
  public:
    PlyValueReader(std::string_view body, bool text, bool swap, const std::string& name)
        : body_(body), words_(body, name), text_(text), swap_(swap), name_(name) {}
    double next(Scalar type) {
        if (text_) {
            while (at_ == line_.size()) {
                at_ = 0;
                if (!words_.line(line_)) {
                    ended();
                }
            }
            return words_.number<double>(line_[at_++]);
        }
        const std::size_t size = size_of(type);
        if (body_.size() < size) {
            ended();
        }
        const auto* from = reinterpret_cast<const std::uint8_t*>(body_.data());
        body_.remove_prefix(size);
        switch (type) {
            case Scalar::i8:
                return static_cast<std::int8_t>(*from);
            case Scalar::u8:
                return *from;
            case Scalar::i16:
                return load<std::int16_t>(from, swap_);
            case Scalar::u16:
                return load<std::uint16_t>(from, swap_);
            case Scalar::i32:
                return load<std::int32_t>(from, swap_);
            case Scalar::u32:
                return load<std::uint32_t>(from, swap_);
            case Scalar::f64:
                return load<double>(from, swap_);
            default:
                return static_cast<double>(load<float>(from, swap_));
        }
    }

  private:
    [[noreturn]] void ended() const {
        refuse_mesh(name_, "the file ends early", "as many values as its header states");
    }
    std::string_view body_;
    TokenReader words_;
    std::vector<std::string_view> line_;
    std::size_t at_ = 0;
    bool text_, swap_;
    const std::string& name_;
};

TriangleMesh parse_ply(std::span<const std::uint8_t> data, const std::string& name) {
    TokenReader head(text_of(data), name);
    std::vector<std::string_view> line;
    std::vector<Element> elements;
    bool text = false;
    bool swap = false;
    bool ras = false;
    bool whole = false;
    while (!whole && head.line(line)) {
        if (line.empty()) {
            continue;
        }
        if (line[0] == "format" && line.size() > 1) {
            text = line[1] == "ascii";
            swap = line[1] == "binary_big_endian";
            if (!text && !swap && line[1] != "binary_little_endian") {
                refuse_mesh(name, fmt::format("format '{}'", line[1].substr(0, 40)), "ascii or binary");
            }
        } else if (line[0] == "comment") {
            ras = ras || std::find(line.begin(), line.end(), "SPACE=RAS") != line.end();
        } else if (line[0] == "element" && line.size() > 2) {
            elements.push_back({std::string(line[1]), head.number<std::size_t>(line[2]), {}});
            if (elements.back().count > 3 * max_triangles) {
                refuse_mesh(name, fmt::format("{} times '{}'", elements.back().count, elements.back().name),
                            fmt::format("at most {}", 3 * max_triangles));
            }
        } else if (line[0] == "property" && !elements.empty() && line.size() > 2) {
            Property p;
            p.list = line[1] == "list";
            if (p.list && line.size() < 5) {
                refuse_mesh(name, "a list property without types", "two types and a name");
            }
            p.count = p.list ? scalar_named(line[2], name) : p.count;
            p.type = scalar_named(line[p.list ? 3 : 1], name);
            p.name = std::string(line.back());
            elements.back().properties.push_back(p);
        }
        whole = line[0] == "end_header";
    }
    if (!whole) {
        refuse_mesh(name, "its header does not end", "'end_header'");
    }
    MeshBuilder gather(name);
    PlyValueReader values(head.rest(), text, swap, name);
    std::vector<std::uint32_t> vertices, corners;
    for (const Element& element : elements) {
        if (element.properties.empty()) {
            continue;  // otherwise an element count without content would loop for long
        }
        for (std::size_t i = 0; i < element.count; ++i) {
            Vec3f place = Vec3f::Zero();
            for (const Property& p : element.properties) {
                if (!p.list) {
                    const double value = values.next(p.type);
                    const int axis = p.name == "x" ? 0 : p.name == "y" ? 1 : p.name == "z" ? 2 : -1;
                    if (axis >= 0) {
                        place[axis] = static_cast<float>(value);
                    }
                    continue;
                }
                const double count = values.next(p.count);
                if (!(count >= 0.0 && count <= 1000.0)) {
                    refuse_mesh(name, fmt::format("a list of {} values", count), "at most 1000");
                }
                corners.clear();
                for (int k = 0; k < static_cast<int>(count); ++k) {
                    const double index = values.next(p.type);
                    if (element.name != "face") {
                        continue;
                    }
                    if (!(index >= 0.0 && index < static_cast<double>(vertices.size()))) {
                        refuse_mesh(name, fmt::format("vertex {}", index),
                                    fmt::format("0 to {}", vertices.size()));
                    }
                    corners.push_back(vertices[static_cast<std::size_t>(index)]);
                }
                if (element.name == "face" && p.name.starts_with("vertex_ind")) {
                    gather.polygon(corners);
                }
            }
            if (element.name == "vertex") {
                vertices.push_back(gather.vertex(place));
            }
        }
    }
    return gather.finish(ras);
}

}  // namespace

TriangleMesh parse_mesh(std::span<const std::uint8_t> data, const std::string& name) {
    const std::string ending = std::filesystem::path(name).extension().string();
    if (ending == ".ply" || text_of(data).starts_with("ply\n") || text_of(data).starts_with("ply\r\n")) {
        return parse_ply(data, name);
    }
    if (ending == ".obj") {
        return parse_obj(data, name);
    }
    if (ending == ".stl") {
        return parse_stl(data, name);
    }
    refuse_mesh(name, "its name does not indicate the format", ".stl, .obj or .ply");
}

static_assert(sizeof(Vec3f) == 12 && sizeof(Triangle) == 12);

TriangleMesh read_mesh(const std::filesystem::path& path, const GuardLimits& limits) {
    const std::string name = path.string();
    const Bytes raw = run_parser(
        [&] {
            const TriangleMesh mesh = parse_mesh(read_bytes(path), name);
            Bytes out(sizeof(std::uint64_t) + 12 * (mesh.vertices.size() + mesh.triangles.size()));
            const std::uint64_t vertices = mesh.vertices.size();
            std::uint8_t* to = out.data();
            std::memcpy(to, &vertices, sizeof(vertices));
            to += sizeof(vertices);
            std::memcpy(to, mesh.vertices.data(), 12 * mesh.vertices.size());
            std::memcpy(to + 12 * mesh.vertices.size(), mesh.triangles.data(), 12 * mesh.triangles.size());
            return out;
        },
        name, limits);
    // The result of a compromised child process is validated, too.
    TriangleMesh mesh;
    const std::uint64_t count = raw.size() >= 8 ? load<std::uint64_t>(raw.data(), false) : 0;
    if (count > raw.size() / 12 || (raw.size() - 8 - 12 * count) % 12 != 0) {
        refuse_mesh(name, "reading it gave no complete surface", "a surface");
    }
    const std::uint8_t* at = raw.data() + 8;
    for (std::uint64_t i = 0; i < count; ++i, at += 12) {
        mesh.vertices.emplace_back(load<float>(at, false), load<float>(at + 4, false),
                                   load<float>(at + 8, false));
    }
    for (; at < raw.data() + raw.size(); at += 12) {
        Triangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            t[k] = load<std::uint32_t>(at + 4 * k, false);
            if (t[k] >= count) {
                refuse_mesh(name, "reading it gave no complete surface", "a surface");
            }
        }
        mesh.triangles.push_back(t);
    }
    return mesh;
}

}  // namespace eti::imaging
