// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/cell.hpp"

#include "common/model/utf8.hpp"
#include "common/session/record.hpp"

namespace eti::session {

void Cell<std::vector<Vec3f>>::pack(const std::vector<Vec3f>& value, std::size_t width, std::byte* row) {
    const Vec3f missing = Vec3f::Constant(missing_number);
    for (std::size_t i = 0; i < width; ++i) {
        Cell<Vec3f>::pack(i < value.size() ? value[i] : missing, 0, row + i * Cell<Vec3f>::bytes(0));
    }
}

void Cell<std::vector<Vec3f>>::unpack(const std::byte* row, std::size_t width, std::vector<Vec3f>& value) {
    value.resize(width);
    for (std::size_t i = 0; i < width; ++i) {
        Cell<Vec3f>::unpack(row + i * Cell<Vec3f>::bytes(0), 0, value[i]);
    }
}

void Cell<std::string>::pack(const std::string& value, std::size_t width, std::byte* row) {
    const std::size_t size = utf8_prefix_length(value, width);
    std::memcpy(row, value.data(), size);
    std::memset(row + size, 0, width - size);
}

void Cell<std::string>::unpack(const std::byte* row, std::size_t width, std::string& value) {
    const char* text = reinterpret_cast<const char*>(row);
    value.assign(text, strnlen(text, width));
}

}  // namespace eti::session
