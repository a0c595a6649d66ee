// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace eti::session {

/// The part of an HDF5 file's first 48 bytes that is out of date after a writer was killed (HDF5 File Format
/// Specification 3.0, II.A.2: superblock versions 2 and 3).
struct Superblock {
    bool marked_open = false;       ///< status flags: open for writing, possibly in single-writer mode
    std::uint64_t stated_size = 0;  ///< end of file as stated [bytes]
    std::uint64_t actual_size = 0;  ///< [bytes]
};

/// Nullopt if the file does not begin with a complete superblock of version 2 or 3 at offset 0.
[[nodiscard]] std::optional<Superblock> read_superblock(const std::filesystem::path& path);

/// Clears the open mark and writes the file's actual size, as `h5clear --status --increment=0` would in one
/// pass. (Run separately, h5clear's first pass truncates the file to the stated size.) Does not use the
/// library, which would have to trust the rest of the file. False on failure, with errno set.
[[nodiscard]] bool repair_superblock(const std::filesystem::path& path);

/// Bob Jenkins' lookup3 hash (hashlittle) with initial value 0, the checksum of HDF5's metadata.
[[nodiscard]] std::uint32_t metadata_checksum(const unsigned char* data, std::size_t size);

}  // namespace eti::session
