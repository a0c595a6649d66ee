// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/atomic_file_writer.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "common/process/files/file_kind.hpp"

namespace eti {

AtomicFileWriter::AtomicFileWriter(std::filesystem::path name)
    : name_(std::move(name)), temporary_path_(fmt::format("{}.unfinished.{}", name_.string(), ::getpid())) {
    std::error_code ignored;
    std::filesystem::remove(temporary_path_, ignored);  // left by a killed program with the same process id
}

AtomicFileWriter::~AtomicFileWriter() {
    std::error_code ignored;
    std::filesystem::remove(temporary_path_, ignored);
}

void AtomicFileWriter::finish() {
    std::filesystem::rename(temporary_path_, name_);
}

std::string full_disk_reason(std::string_view message) {
    for (const int error : {ENOSPC, EDQUOT, EFBIG}) {
        const std::string reason = std::strerror(error);
        if (message.find(reason) != std::string_view::npos) {
            return reason;
        }
    }
    return "";
}

std::string write_file_atomically(const std::filesystem::path& name, std::string_view bytes) {
    if (const std::string kind = describe_blocking_entry(name); !kind.empty()) {
        return "is " + kind;
    }
    AtomicFileWriter file(name);
    std::FILE* const out = std::fopen(file.path().c_str(), "wb");
    if (out == nullptr) {
        return std::strerror(errno);
    }
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
    const int reason = errno;
    if (const bool closed = std::fclose(out) == 0; !written || !closed) {
        return std::strerror(written ? errno : reason);
    }
    try {
        file.finish();
    } catch (const std::filesystem::filesystem_error& error) {
        return error.code().message();
    }
    return "";
}

}  // namespace eti
