// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "common/process/files/descriptor.hpp"

namespace eti::session {

/// Advisory lock that shows other processes that this one is writing a file. The kernel releases it when the
/// process ends, however it ends. A file marked inside as open for writing, but without this lock, was
/// therefore left by a killed writer. (A lock of the open file description; it does not conflict with the
/// HDF5 library's locks.) On a file system without locks it has no effect.
class RecordingLock {
  public:
    void set(const std::filesystem::path& path);
    void clear() { file_.close(); }
    /// The file's descriptor if the file has been deleted since; else nullopt.
    [[nodiscard]] std::optional<int> deleted() const;
    /// Whether another program has made a new HDF5 file in place of the one that was locked: its superblock
    /// is not the same, apart from the end of the file, which rises.
    [[nodiscard]] bool overwritten() const;

  private:
    /// What a superblock of version 3 (48 bytes) states for good while the file is written, and the root
    /// group's signature: a writer that flushes after the other program's truncation restores its superblock
    /// over an empty file.
    struct Identity {
        std::array<char, 28> begin{};  ///< signature, version, sizes, flags, base and extension addresses
        std::array<char, 8> root{};    ///< address of the root group
        std::array<char, 4> root_signature{};
        bool operator==(const Identity&) const = default;
    };
    [[nodiscard]] std::optional<Identity> identity() const;

    Descriptor file_;
    std::optional<Identity> locked_;
};

/// Whether a process (this one included) holds the lock on the file.
[[nodiscard]] bool is_being_written(const std::filesystem::path& path);

}  // namespace eti::session
