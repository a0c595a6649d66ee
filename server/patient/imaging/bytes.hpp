// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eti::imaging {

using Bytes = std::vector<std::uint8_t>;

/// Reads a whole file. Throws VolumeError if it cannot be read, is not a regular file, or is larger than
/// `most` [bytes].
[[nodiscard]] Bytes read_bytes(const std::filesystem::path& file, std::size_t most = std::size_t{5} << 30);

/// Decompresses gzip data up to `most` bytes; truncates longer data, and data with a damaged end. Throws
/// VolumeError, starting with `file`, if the data are damaged from the start.
[[nodiscard]] Bytes gunzip(std::span<const std::uint8_t> data, std::size_t most, const std::string& file);
[[nodiscard]] Bytes gzip(std::span<const std::uint8_t> data);
[[nodiscard]] inline bool is_gzip(std::span<const std::uint8_t> data) {
    return data.size() > 2 && data[0] == 0x1f && data[1] == 0x8b;
}

/// Scalar type in a file.
enum class Scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
[[nodiscard]] std::size_t size_of(Scalar type);

/// Converts scalars to floats; `swap`: the file's byte order is not the host's.
[[nodiscard]] std::vector<float> to_floats(std::span<const std::uint8_t> data, Scalar type, bool swap);

template <class T>
[[nodiscard]] T load(const std::uint8_t* from, bool swap) {
    std::uint8_t raw[sizeof(T)];
    for (std::size_t k = 0; k < sizeof(T); ++k) {
        raw[k] = from[swap ? sizeof(T) - 1 - k : k];
    }
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
}

/// Appends a scalar in little-endian byte order, the host's.
template <class T>
void store(Bytes& to, const T& value) {
    static_assert(std::endian::native == std::endian::little);
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
    to.insert(to.end(), raw, raw + sizeof(T));
}

/// Writes to a temporary file beside `file` and renames it, so that `file` is complete or absent. Throws
/// VolumeError with the remedy.
void write_bytes(const std::filesystem::path& file, std::span<const std::uint8_t> data);
void write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace eti::imaging
