// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "reader.hpp"

namespace eti::fuzz {

/// A file in memory, for readers that need a path. HDF5 needs one that resolves to a name, which a
/// descriptor's does not.
class MemoryFile {
  public:
    MemoryFile() { require(descriptor_ >= 0, "no file can be made in /dev/shm"); }
    ~MemoryFile() {
        ::close(descriptor_);
        ::unlink(path_.c_str());
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    void hold(const void* data, std::size_t size) const {
        require(::ftruncate(descriptor_, 0) == 0 &&
                    ::pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size),
                "the file in memory cannot be written");
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_ = "/dev/shm/eti-fuzz-" + std::to_string(::getpid());
    int descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
};

}  // namespace eti::fuzz
