// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/escaped.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace eti {

namespace {

/// Length [bytes] of the UTF-8 character at `at`; 0 if there is none.
std::size_t character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(at);
    const std::size_t size = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
    if (size == 0 || at + size > text.size()) {
        return 0;
    }
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte(at + i) & 0xc0u) != 0x80u) {
            return 0;
        }
    }
    return size;
}

std::string hexadecimal(std::string_view bytes) {
    std::string out;
    for (const char byte : bytes) {
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
    return out;
}

std::string escape(std::string_view text, std::string_view kept, std::size_t most) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = character_at(text, at);
        const auto first = static_cast<unsigned char>(text[at]);
        // U+0080 to U+009F: some terminals interpret U+009B as the start of a control sequence.
        const bool control = size == 1   ? (first < 0x20 || first == 0x7f) && kept.find(text[at]) == kept.npos
                             : size == 2 ? first == 0xc2 && static_cast<unsigned char>(text[at + 1]) < 0xa0
                                         : size == 0;
        const std::string next = !control        ? std::string(text.substr(at, size))
                                 : first == '\n' ? "\\n"
                                 : first == '\t'
                                     ? "\\t"
                                     : hexadecimal(text.substr(at, std::max<std::size_t>(size, 1)));
        if (out.size() + next.size() > most) {
            return out + "...";
        }
        out += next;
        at += std::max<std::size_t>(size, 1);
    }
    return out;
}

}  // namespace

std::string escaped(std::string_view text, std::size_t most) {
    return escape(text, {}, most);
}

std::string escaped_lines(std::string_view text) {
    return escape(text, "\n\t", std::string_view::npos);
}

}  // namespace eti
