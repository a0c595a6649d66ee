// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace eti {

/// FNV-1a over raw bytes, 64 bits. Distinguishes states and files; not cryptographic.
class Hash {
  public:
    template <class T, std::size_t extent>
    void add(std::span<T, extent> values) {
        bytes(values.data(), values.size_bytes());
    }
    void add(std::string_view text) { bytes(text.data(), text.size()); }
    void bytes(const void* data, std::size_t size) {
        const auto* p = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) {
            value_ = (value_ ^ p[i]) * 0x100000001b3ULL;
        }
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace eti
