// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <optional>

#include "common/process/descriptor.hpp"

namespace eti::session {

/// Shows other processes that this one is writing a file. The kernel takes the mark away when the
/// process ends, however it ends, so a file that is marked inside as open for writing but bears no
/// such mark was left by a killed writer. (An advisory lock of the open file description; it does not
/// meet the locks that the HDF5 library takes.) Where the file system knows no locks, nothing is shown.
class LiveMark {
  public:
    void set(const std::filesystem::path& path);
    void clear() { file_.close(); }
    /// Whether the file has been deleted since; its descriptor then, else nothing.
    [[nodiscard]] std::optional<int> deleted() const;

  private:
    Descriptor file_;
};

/// Whether a process (this one included) has the mark on the file.
[[nodiscard]] bool being_written(const std::filesystem::path& path);

}  // namespace eti::session
