// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

#include "common/hdf5/group.hpp"

namespace eti::hdf5 {

enum class Access {
    read,
    read_beside_writer,  ///< also a file that a writer has open: waits for what is just being written
    read_left_behind,    ///< also a file that a writer left behind when it was killed
    modify,
    append_beside_readers  ///< single writer, multiple readers: what is on disk is consistent at any time
};

/// Throws Error for what a person can see without the library: missing, a folder, empty, no permission.
void require_plain_file(const std::filesystem::path& path);

/// An HDF5 file and its root group. Functions throw Error.
class File {
  public:
    File() = default;
    /// Creates the file, in the format of HDF5 1.10 (which the access modes above need); refuses to replace
    /// one.
    [[nodiscard]] static File create(const std::filesystem::path& path);
    /// `shown_as`: what messages call it, where that is not its path.
    [[nodiscard]] static File open(const std::filesystem::path& path, Access access,
                                   const std::filesystem::path& shown_as = {});

    [[nodiscard]] const Group& root() const { return root_; }
    [[nodiscard]] hid_t id() const { return id_.get(); }

    /// Writes out and closes. Throws Error if that fails.
    void close();
    /// Writes out; false on failure.
    [[nodiscard]] bool flush() const { return H5Fflush(id_.get(), H5F_SCOPE_GLOBAL) >= 0; }
    /// Lets go of a file that can no longer be written, without touching it again.
    void abandon();

  private:
    File(Handle id, const std::filesystem::path& path);

    Handle id_;
    Group root_;
    std::filesystem::path path_;
};

}  // namespace eti::hdf5
