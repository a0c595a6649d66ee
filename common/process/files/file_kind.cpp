// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/file_kind.hpp"

namespace eti {

std::string describe_non_regular(const std::filesystem::path& path) {
    std::error_code error;
    switch (std::filesystem::status(path, error).type()) {
        case std::filesystem::file_type::regular:
            return "";
        case std::filesystem::file_type::directory:
            return "a folder";
        case std::filesystem::file_type::fifo:
            return "a pipe";
        case std::filesystem::file_type::block:
        case std::filesystem::file_type::character:
            return "a device";
        case std::filesystem::file_type::socket:
            return "a socket";
        default:
            return "nothing";
    }
}

std::string describe_blocking_entry(const std::filesystem::path& path) {
    const std::string kind = describe_non_regular(path);
    return kind == "nothing" ? "" : kind;
}

}  // namespace eti
