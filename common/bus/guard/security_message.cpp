// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/security_message.hpp"

namespace eti::bus {

namespace {

// A handshake message has one holder with twelve properties.
constexpr std::uint32_t max_holders = 8, max_properties = 32;

/// A string or a sequence of octets: length and content, padded to four bytes.
bool skip_octets(Reader& in) {
    const std::uint32_t length = in.u32();
    in.skip(length);
    // The last padding may be missing.
    if (in.left() > 0) {
        in.align();
    }
    return in.whole();
}

/// Pairs of a name and a value.
bool skip_properties(Reader& in) {
    const std::uint32_t count = in.u32();
    if (count > max_properties) {
        return false;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!skip_octets(in) || !skip_octets(in)) {
            return false;
        }
    }
    return in.whole();
}

bool skip_data_holder(Reader& in) {
    return skip_octets(in) && skip_properties(in) && skip_properties(in);
}

}  // namespace

bool is_valid_token(Bytes content, bool little_endian) {
    Reader in(content, little_endian);
    return skip_data_holder(in);
}

bool is_valid_stateless_message(Bytes payload) {
    constexpr std::size_t encapsulation = 4, identity = 24, guid = 16;
    if (payload.size() < encapsulation || payload[0] != 0 || payload[1] > 1) {
        return false;
    }
    Reader in(payload.subspan(encapsulation), payload[1] == 1);
    in.skip(2 * identity + 3 * guid);
    if (!skip_octets(in)) {
        return false;
    }
    const std::uint32_t holders = in.u32();
    if (holders > max_holders) {
        return false;
    }
    for (std::uint32_t i = 0; i < holders; ++i) {
        if (!skip_data_holder(in)) {
            return false;
        }
    }
    return in.whole();
}

}  // namespace eti::bus
