// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/folder.hpp"

#include <fmt/format.h>
#include <stdexcept>
#include <system_error>

namespace eti {

void make_folder(const std::filesystem::path& folder, std::string_view option) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw std::runtime_error(fmt::format("{}: cannot create the folder: {}; choose another with {}",
                                             folder.string(), error.message(), option));
    }
}

}  // namespace eti
