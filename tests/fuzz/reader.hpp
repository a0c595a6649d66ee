// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

// Common to the fuzz targets: a reader returns what it read or throws its own error. Anything else (another
// exception, a signal, a sanitizer report, a hang) is a finding.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace eti::fuzz {

/// Aborts the program as a finding.
[[noreturn]] inline void found(std::string_view what) {
    std::fprintf(stderr, "finding: %.*s\n", static_cast<int>(what.size()), what.data());
    std::abort();
}

inline void require(bool holds, std::string_view what) {
    if (!holds) {
        found(what);
    }
}

/// Calls `read`, whose only exception may be `Error`: its message begins with the file's name and is short
/// enough for a person to read.
template <class Error, class Read>
void read_or_refuse(const std::string& file, const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        const std::string_view message = error.what();
        require(message.starts_with(file), "a message without the file's name: " + std::string(message));
        require(message.size() < 2000, "a message that nobody reads: " + std::string(message));
    }
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace eti::fuzz
