// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/liveness.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace eti::session {

namespace {

struct flock whole_file(short kind) {
    struct flock lock {};
    lock.l_type = kind;
    lock.l_whence = SEEK_SET;
    return lock;
}

}  // namespace

void LiveMark::set(const std::filesystem::path& path) {
    clear();
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor_ >= 0) {
        struct flock lock = whole_file(F_WRLCK);
        (void)::fcntl(descriptor_, F_OFD_SETLK, &lock);
    }
}

void LiveMark::clear() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        descriptor_ = -1;
    }
}

std::optional<int> LiveMark::deleted() const {
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 || status.st_nlink > 0) {
        return std::nullopt;
    }
    return descriptor_;
}

bool being_written(const std::filesystem::path& path) {
    const int descriptor =
        ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe would wait for a writer
    if (descriptor < 0) {
        return false;
    }
    struct flock lock = whole_file(F_RDLCK);
    const bool marked = ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
    ::close(descriptor);
    return marked;
}

}  // namespace eti::session
