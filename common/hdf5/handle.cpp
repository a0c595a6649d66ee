// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/hdf5/handle.hpp"

#include <mutex>
#include <string_view>

namespace eti::hdf5 {

void prepare_thread() {
    static std::once_flag once;
    std::call_once(once, [] {
        H5dont_atexit();
        H5open();
    });
    // The error stack and its printing are per thread.
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

namespace {

herr_t keep_innermost(unsigned, const H5E_error2_t* error, void* text) {
    auto& innermost = *static_cast<std::string*>(text);
    if (innermost.empty() && error->desc != nullptr) {
        innermost = error->desc;
    }
    return 0;
}

}  // namespace

std::string last_error() {
    std::string text;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
    // Keep only the system's own message of a failed system call; drop file descriptor, buffer and offset.
    constexpr std::string_view mark = "error message = '";
    if (const std::size_t start = text.find(mark); start != std::string::npos) {
        const std::size_t first = start + mark.size();
        return text.substr(first, text.find('\'', first) - first);
    }
    return text.empty() ? "unknown error in the HDF5 library" : text;
}

}  // namespace eti::hdf5
