// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/superblock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>

#include "common/process/files/descriptor.hpp"

namespace eti::session {

namespace {

// Offsets [bytes] in a superblock of version 2 or 3 with 8-byte addresses.
constexpr std::size_t version_at = 8, address_size_at = 9, flags_at = 11, end_at = 28, checksum_at = 44,
                      whole = 48;
constexpr std::array<unsigned char, 8> signature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};

using Bytes = std::array<unsigned char, whole>;

// Numbers in the file are little-endian, whatever the machine.
template <class T>
T get(const unsigned char* at) {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        value |= static_cast<T>(at[i]) << (8 * i);
    }
    return value;
}

template <class T>
void put(unsigned char* at, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        at[i] = static_cast<unsigned char>(value >> (8 * i));
    }
}

bool valid(const Bytes& bytes) {
    return std::equal(signature.begin(), signature.end(), bytes.begin()) &&
           (bytes[version_at] == 2 || bytes[version_at] == 3) && bytes[address_size_at] == 8 &&
           get<std::uint32_t>(&bytes[checksum_at]) == metadata_checksum(bytes.data(), checksum_at);
}

Descriptor opened(const std::filesystem::path& path, int flags) {
    // Opening a pipe would block.
    return Descriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK));
}

}  // namespace

std::uint32_t metadata_checksum(const unsigned char* data, std::size_t size) {
    std::uint32_t a = 0xdeadbeefu + static_cast<std::uint32_t>(size);
    std::uint32_t b = a;
    std::uint32_t c = a;
    const auto take = [&](const unsigned char* block) {
        a += get<std::uint32_t>(block);
        b += get<std::uint32_t>(block + 4);
        c += get<std::uint32_t>(block + 8);
    };
    while (size > 12) {
        take(data);
        a -= c, a ^= std::rotl(c, 4), c += b;
        b -= a, b ^= std::rotl(a, 6), a += c;
        c -= b, c ^= std::rotl(b, 8), b += a;
        a -= c, a ^= std::rotl(c, 16), c += b;
        b -= a, b ^= std::rotl(a, 19), a += c;
        c -= b, c ^= std::rotl(b, 4), b += a;
        data += 12;
        size -= 12;
    }
    if (size == 0) {
        return c;
    }
    std::array<unsigned char, 12> rest{};
    std::memcpy(rest.data(), data, size);
    take(rest.data());
    c ^= b, c -= std::rotl(b, 14);
    a ^= c, a -= std::rotl(c, 11);
    b ^= a, b -= std::rotl(a, 25);
    c ^= b, c -= std::rotl(b, 16);
    a ^= c, a -= std::rotl(c, 4);
    b ^= a, b -= std::rotl(a, 14);
    c ^= b, c -= std::rotl(b, 24);
    return c;
}

std::optional<Superblock> read_superblock(const std::filesystem::path& path) {
    const Descriptor file = opened(path, O_RDONLY);
    Bytes bytes{};
    if (!file || ::pread(file.get(), bytes.data(), whole, 0) != static_cast<ssize_t>(whole) ||
        !valid(bytes)) {
        return std::nullopt;
    }
    const off_t size = ::lseek(file.get(), 0, SEEK_END);
    return Superblock{bytes[flags_at] != 0, get<std::uint64_t>(&bytes[end_at]),
                      static_cast<std::uint64_t>(size)};
}

bool repair_superblock(const std::filesystem::path& path) {
    const Descriptor file = opened(path, O_RDWR);
    Bytes bytes{};
    if (!file) {
        return false;
    }
    if (::pread(file.get(), bytes.data(), whole, 0) != static_cast<ssize_t>(whole) || !valid(bytes)) {
        errno = EINVAL;
        return false;
    }
    bytes[flags_at] = 0;
    put(&bytes[end_at], static_cast<std::uint64_t>(::lseek(file.get(), 0, SEEK_END)));
    put(&bytes[checksum_at], metadata_checksum(bytes.data(), checksum_at));
    return ::pwrite(file.get(), bytes.data(), whole, 0) == static_cast<ssize_t>(whole) &&
           ::fsync(file.get()) == 0;
}

}  // namespace eti::session
