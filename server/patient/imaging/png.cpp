// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/png.hpp"

#include <zlib.h>

#include <string_view>

namespace eti::imaging {

namespace {

void append_number(Bytes& to, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        to.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}

void append_chunk(Bytes& to, std::string_view type, const Bytes& data) {
    append_number(to, static_cast<std::uint32_t>(data.size()));
    const std::size_t from = to.size();
    to.insert(to.end(), type.begin(), type.end());
    to.insert(to.end(), data.begin(), data.end());
    append_number(
        to, static_cast<std::uint32_t>(::crc32(0, to.data() + from, static_cast<uInt>(to.size() - from))));
}

}  // namespace

Bytes encode_png(const Picture& picture) {
    const std::size_t row = 3 * static_cast<std::size_t>(picture.width);
    Bytes raw;
    raw.reserve((row + 1) * static_cast<std::size_t>(picture.height));
    for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height); ++y) {
        raw.push_back(0);  // no filter
        raw.insert(raw.end(), picture.rgb.begin() + static_cast<std::ptrdiff_t>(y * row),
                   picture.rgb.begin() + static_cast<std::ptrdiff_t>((y + 1) * row));
    }
    uLongf size = ::compressBound(raw.size());
    Bytes packed(size);
    ::compress2(packed.data(), &size, raw.data(), raw.size(), 6);
    packed.resize(size);

    Bytes head;
    append_number(head, static_cast<std::uint32_t>(picture.width));
    append_number(head, static_cast<std::uint32_t>(picture.height));
    head.insert(head.end(), {8, 2, 0, 0, 0});
    Bytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    append_chunk(out, "IHDR", head);
    append_chunk(out, "IDAT", packed);
    append_chunk(out, "IEND", {});
    return out;
}

}  // namespace eti::imaging
