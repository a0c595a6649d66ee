// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/unfinished_file.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "common/process/file_kind.hpp"

namespace eti {

UnfinishedFile::UnfinishedFile(std::filesystem::path name)
    : name_(std::move(name)), unfinished_(fmt::format("{}.unfinished.{}", name_.string(), ::getpid())) {
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);  // of a killed program that had the same number
}

UnfinishedFile::~UnfinishedFile() {
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);
}

void UnfinishedFile::finish() {
    std::filesystem::rename(unfinished_, name_);
}

std::string write_whole(const std::filesystem::path& name, std::string_view bytes) {
    if (const std::string kind = in_the_way(name); !kind.empty()) {
        return "is " + kind;
    }
    UnfinishedFile file(name);
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
