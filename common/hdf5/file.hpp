// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

#include "common/hdf5/group.hpp"

namespace eti::hdf5 {

enum class Access {
    read,
    read_swmr,      ///< also a file that a writer has open: retries while a block is being written
    read_orphaned,  ///< also a file that a killed writer left behind
    modify,
    append_swmr  ///< single writer, multiple readers: the file is consistent at any time
};

/// Throws Error for problems that can be found without the library: missing, a folder, empty, no permission.
void require_regular_file(const std::filesystem::path& path);

/// An HDF5 file and its root group. Functions throw Error.
class File {
  public:
    File() = default;
    /// Creates a file in the format of HDF5 1.10, which the access modes above need. Never replaces an
    /// existing one.
    [[nodiscard]] static File create(const std::filesystem::path& path);
    /// `display_name`: the name used in messages, where it is not the path.
    [[nodiscard]] static File open(const std::filesystem::path& path, Access access,
                                   const std::filesystem::path& display_name = {});

    [[nodiscard]] const Group& root() const { return root_; }
    [[nodiscard]] hid_t id() const { return id_.get(); }

    /// Flushes and closes. Throws Error on failure.
    void close();
    /// Flushes; false on failure.
    [[nodiscard]] bool flush() const { return H5Fflush(id_.get(), H5F_SCOPE_GLOBAL) >= 0; }
    /// Drops a file that can no longer be written, without any further access to it.
    void abandon();

  private:
    File(Handle id, const std::filesystem::path& path);

    Handle id_;
    Group root_;
    std::filesystem::path path_;
};

}  // namespace eti::hdf5
