// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

namespace eti::bus {

/// Writer of a submessage: the participant's GUID prefix and the writer's entity id, as on the wire.
struct WriterId {
    std::array<std::uint8_t, 12> participant;
    std::array<std::uint8_t, 4> entity;

    auto operator<=>(const WriterId&) const = default;
};

/// A submessage that a writer sends.
struct WriterSubmessage {
    WriterId writer;
    /// For a heartbeat or a gap: the sequence number to which it advances the writer's readers. Otherwise 0.
    std::int64_t up_to = 0;
};

/// Whether a datagram is safe for the library: RTPS 2.x (OMG DDSI-RTPS 2.5, chapter 9.4) with complete
/// submessages, each of the length that its content needs, and plausible sequence numbers. Fast DDS 2.9.1
/// ends the process on a statistics submessage that is not the last. It also loops over any range that a
/// heartbeat, a gap or an acknowledgement names. Secured submessages are left to the security plug-in.
/// `refused` is called for every submessage that a writer sends; if it returns true, the whole datagram is
/// rejected.
[[nodiscard]] bool is_well_formed(std::span<const std::uint8_t> datagram,
                                  const std::function<bool(const WriterSubmessage&)>& refused = {});

/// Maximum range of a heartbeat or a gap, and of an acknowledgement's bitmap [samples]; a session's histories
/// are shorter.
inline constexpr std::int64_t max_sequence_range = 1 << 16;
/// Largest sequence number: reached after thirty years at 1 kHz.
inline constexpr std::int64_t max_sequence_number = std::int64_t{1} << 40;
/// Largest fragmented message [bytes]; a scene's largest object has 1 MB.
inline constexpr std::uint32_t max_sample_bytes = 16u << 20;

}  // namespace eti::bus
