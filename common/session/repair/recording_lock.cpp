// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/recording_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>

namespace eti::session {

namespace {

struct flock whole_file(short kind) {
    struct flock lock {};
    lock.l_type = kind;
    lock.l_whence = SEEK_SET;
    return lock;
}

}  // namespace

void RecordingLock::set(const std::filesystem::path& path) {
    clear();
    file_ = Descriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    if (file_) {
        struct flock lock = whole_file(F_WRLCK);
        (void)::fcntl(file_.get(), F_OFD_SETLK, &lock);
        locked_ = identity();
    }
}

std::optional<RecordingLock::Identity> RecordingLock::identity() const {
    constexpr off_t root_at = 36;  // after the end of the file
    Identity found;
    std::uint64_t header = 0;  // addresses have 8 bytes, little endian
    const auto read_at = [&](auto& bytes, off_t at) {
        return ::pread(file_.get(), bytes.data(), bytes.size(), at) == static_cast<ssize_t>(bytes.size());
    };
    if (!file_ || !read_at(found.begin, 0) || !read_at(found.root, root_at)) {
        return std::nullopt;
    }
    for (std::size_t i = found.root.size(); i-- > 0;) {
        header = header << 8 | static_cast<unsigned char>(found.root[i]);
    }
    return read_at(found.root_signature, static_cast<off_t>(header)) ? std::optional(found) : std::nullopt;
}

bool RecordingLock::overwritten() const {
    return locked_ && identity() != locked_;
}

std::optional<int> RecordingLock::deleted() const {
    struct stat status {};
    if (!file_ || ::fstat(file_.get(), &status) != 0 || status.st_nlink > 0) {
        return std::nullopt;
    }
    return file_.get();
}

bool is_being_written(const std::filesystem::path& path) {
    // Opening a pipe would block until it has a writer.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct flock lock = whole_file(F_RDLCK);
    return file && ::fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace eti::session
