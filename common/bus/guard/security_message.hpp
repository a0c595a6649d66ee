// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "common/bus/guard/reader.hpp"

namespace eti::bus {

/// The built-in writer of handshake messages, which come before anything is encrypted (DDS Security 1.1,
/// 7.4.5: BuiltinParticipantStatelessMessageWriter).
inline constexpr std::array<std::uint8_t, 4> stateless_message_writer = {0x00, 0x02, 0x01, 0xc3};

/// Whether a DataHolder (DDS Security 1.1, 7.2.3) ends within `content`. Fast DDS 2.9.1 allocates as many
/// properties as it counts.
[[nodiscard]] bool is_valid_token(Bytes content, bool little_endian);

/// Whether `payload` is the encapsulated CDR of a ParticipantGenericMessage (7.4.5) whose counts and lengths
/// agree with its size.
[[nodiscard]] bool is_valid_stateless_message(Bytes payload);

}  // namespace eti::bus
