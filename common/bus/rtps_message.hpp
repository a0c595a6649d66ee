// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

namespace eti::bus {

/// Who wrote a submessage: the participant's prefix and the writer's entity, as on the wire.
struct WriterId {
    std::array<std::uint8_t, 12> participant;
    std::array<std::uint8_t, 4> entity;

    auto operator<=>(const WriterId&) const = default;
};

/// A submessage that a writer sends.
struct Written {
    WriterId writer;
    /// Of a heartbeat or a gap: the number up to which it moves the writer's readers. Else 0.
    std::int64_t up_to = 0;
};

/// Whether the library may be given a datagram: RTPS 2.x (OMG DDSI-RTPS 2.5, chapter 9.4) of whole
/// submessages, each of the length that its content needs, with numbers that a session can have. Fast
/// DDS 2.9.1 ends the process on a statistics submessage that is not the last, and loops over whatever range
/// a heartbeat, a gap or an acknowledgement names. Secured submessages are the security plug-in's to check.
/// `refused` is asked for every submessage that a writer sends; one that it refuses makes the whole datagram
/// unbearable.
[[nodiscard]] bool bearable(std::span<const std::uint8_t> datagram,
                            const std::function<bool(const Written&)>& refused = {});

/// Samples in a heartbeat's or a gap's range, or an acknowledgement's place; a session's histories are
/// shorter.
inline constexpr std::int64_t longest_range = 1 << 16;
/// Largest sequence number: at 1 kHz it takes thirty years.
inline constexpr std::int64_t largest_number = std::int64_t{1} << 40;
/// Largest message that comes in fragments [bytes]; a scene's largest object has 1 MB.
inline constexpr std::uint32_t largest_sample = 16u << 20;

}  // namespace eti::bus
