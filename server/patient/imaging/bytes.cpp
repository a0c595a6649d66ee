// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/bytes.hpp"

#include <zlib.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <fstream>

#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/file_kind.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

Bytes read_bytes(const std::filesystem::path& file, std::size_t most) {
    if (const std::string kind = describe_non_regular(file); !kind.empty()) {
        throw VolumeError(fmt::format("{}: {}; expected a file. Remedy: check the path.", file.string(),
                                      kind == "nothing" ? "does not exist" : "is " + kind));
    }
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    if (error || size > most) {
        throw VolumeError(
            fmt::format("{}: has {} bytes; expected at most {}. Remedy: crop the volume to head and neck.",
                        file.string(), size, most));
    }
    std::ifstream in(file, std::ios::binary);
    Bytes data(size);
    in.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(size));
    if (!in || static_cast<std::size_t>(in.gcount()) != size) {
        throw VolumeError(fmt::format("{}: cannot be read. Remedy: check its permissions.", file.string()));
    }
    return data;
}

Bytes gunzip(std::span<const std::uint8_t> data, std::size_t most, const std::string& file) {
    z_stream stream{};
    constexpr int gzip_or_zlib = 15 + 32;
    if (inflateInit2(&stream, gzip_or_zlib) != Z_OK) {
        throw VolumeError(file + ": cannot initialise zlib (out of memory). Remedy: close other programs.");
    }
    Bytes out;
    std::size_t taken = 0;
    std::array<std::uint8_t, 1 << 16> part{};
    int state = Z_OK;
    std::string finding;
    while (state == Z_OK && out.size() < most) {
        if (stream.avail_in == 0 && taken < data.size()) {
            const std::size_t next = std::min<std::size_t>(data.size() - taken, 1u << 30);
            stream.next_in = const_cast<std::uint8_t*>(data.data() + taken);
            stream.avail_in = static_cast<uInt>(next);
            taken += next;
        }
        stream.next_out = part.data();
        stream.avail_out = static_cast<uInt>(part.size());
        state = inflate(&stream, Z_NO_FLUSH);
        const std::size_t got = part.size() - stream.avail_out;
        out.insert(out.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(got));
    }
    if (state != Z_OK && state != Z_STREAM_END) {
        finding = stream.msg != nullptr ? stream.msg : "unexpected end";
    }
    inflateEnd(&stream);
    if (!finding.empty()) {
        throw VolumeError(
            fmt::format("{}: the compressed data are damaged after {} bytes ({}); expected whole "
                        "gzip data. Remedy: copy or export the file again.",
                        file, out.size(), finding));
    }
    out.resize(std::min(out.size(), most));
    return out;
}

Bytes gzip(std::span<const std::uint8_t> data) {
    z_stream stream{};
    constexpr int as_gzip = 15 + 16;
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, as_gzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        throw VolumeError("zlib could not be started (out of memory). Remedy: close other programs.");
    }
    Bytes out;
    std::vector<std::uint8_t> part(1 << 20);
    std::size_t taken = 0;
    int state = Z_OK;
    while (state != Z_STREAM_END) {
        if (stream.avail_in == 0) {
            const std::size_t next = std::min<std::size_t>(data.size() - taken, 1u << 30);
            stream.next_in = const_cast<std::uint8_t*>(data.data() + taken);
            stream.avail_in = static_cast<uInt>(next);
            taken += next;
        }
        stream.next_out = part.data();
        stream.avail_out = static_cast<uInt>(part.size());
        state = deflate(&stream, taken == data.size() ? Z_FINISH : Z_NO_FLUSH);
        out.insert(out.end(), part.begin(),
                   part.begin() + static_cast<std::ptrdiff_t>(part.size() - stream.avail_out));
    }
    deflateEnd(&stream);
    return out;
}

std::size_t size_of(Scalar type) {
    constexpr std::array<std::size_t, 10> sizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

namespace {

template <class T>
void convert(std::span<const std::uint8_t> data, bool swap, std::vector<float>& out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = static_cast<float>(load<T>(data.data() + i * sizeof(T), swap));
    }
}

}  // namespace

std::vector<float> to_floats(std::span<const std::uint8_t> data, Scalar type, bool swap) {
    std::vector<float> out(data.size() / size_of(type));
    constexpr std::array converters = {
        &convert<std::int8_t>,  &convert<std::uint8_t>,  &convert<std::int16_t>, &convert<std::uint16_t>,
        &convert<std::int32_t>, &convert<std::uint32_t>, &convert<std::int64_t>, &convert<std::uint64_t>,
        &convert<float>,        &convert<double>};
    converters[static_cast<std::size_t>(type)](data, swap, out);
    return out;
}

void write_bytes(const std::filesystem::path& file, std::span<const std::uint8_t> data) {
    if (const std::string kind = describe_blocking_entry(file); !kind.empty()) {
        throw VolumeError(fmt::format(
            "{}: is {}; expected a file or a new name. Remedy: choose another name.", file.string(), kind));
    }
    if (const std::string why = write_file_atomically(file, bytes_of(data)); !why.empty()) {
        throw VolumeError(
            fmt::format("{}: cannot be written: {}. Remedy: check that the folder exists and is writable and "
                        "that the disk is not full.",
                        file.string(), why));
    }
}

void write_text(const std::filesystem::path& file, std::string_view text) {
    write_bytes(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace eti::imaging
