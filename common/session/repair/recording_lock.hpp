// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

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

  private:
    Descriptor file_;
};

/// Whether a process (this one included) holds the lock on the file.
[[nodiscard]] bool is_being_written(const std::filesystem::path& path);

}  // namespace eti::session
