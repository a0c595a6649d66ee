// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/guard/reader.hpp"

namespace eti::bus {

/// Writer of a submessage: the participant's GUID prefix and the writer's entity id, as on the wire.
struct WriterId {
    ParticipantId participant;
    std::array<std::uint8_t, 4> entity;

    auto operator<=>(const WriterId&) const = default;
};

/// Consecutive fragments of one sample.
struct Fragments {
    std::int64_t sequence_number = 0;
    std::uint32_t first = 0;  ///< from 1
    std::uint16_t count = 0;
    std::uint16_t size = 0;    ///< [bytes] of each but the last
    std::uint32_t sample = 0;  ///< [bytes] of the whole sample
    Bytes payload;             ///< in the datagram
};

/// Bytes that the library may not have as they are.
struct Replacement {
    Bytes place;  ///< in the datagram
    std::vector<std::uint8_t> by;
};

/// A participant's announcement of itself (DDSI-RTPS 2.5, 8.5.3: SPDP).
struct Announcement {
    Bytes content;            ///< parameters, in the datagram
    bool goodbye = false;     ///< that the participant leaves
    bool of_another = false;  ///< of a participant other than the datagram's
};

/// Discovery data that asks for datagrams at an address beyond this machine.
struct DistantLocator {
    Bytes parameter;  ///< identifier of the parameter, in the datagram; zero makes it padding
    std::optional<std::array<std::uint8_t, 4>> address;  ///< of IPv4; other kinds have none here
};

/// A submessage that a writer sends.
struct WriterSubmessage {
    WriterId writer;
    /// For a heartbeat or a gap: the sequence number to which it advances the writer's readers. Otherwise 0.
    std::int64_t up_to = 0;
    std::int64_t whole_sample = 0;       ///< sequence number of a sample sent at once; else 0
    std::optional<Fragments> fragments;  ///< of a sample sent in fragments
    std::optional<Announcement> announcement;
    /// To be made before the library may have the datagram. Discovery parameters that describe a type become
    /// padding. A gap's bitmap is cut off at the first number that it does not name; the writer repeats the
    /// rest when it is asked.
    std::vector<Replacement> replacements;
    std::vector<DistantLocator> distant_locators;
};

/// Whether a datagram is safe for the library: RTPS 2.x (OMG DDSI-RTPS 2.5, chapter 9.4) with complete
/// submessages, each of the length that its content needs, and plausible sequence numbers. Fast DDS 2.9.1
/// ends the process on a statistics submessage that is not the last and on fragments of a key. It also loops
/// over any range that a heartbeat, a gap or an acknowledgement names, allocates as many elements as an
/// identity token or a handshake message counts, and delivers a sample of which it has some fragments when a
/// gap's bitmap names it. Secured submessages are left to the security plug-in.
/// Fragments are checked one by one; FragmentGuard compares those of one sample.
/// `refused` is called for every submessage that a writer sends; if it returns true, the whole datagram is
/// rejected.
[[nodiscard]] bool is_well_formed(Bytes datagram,
                                  const std::function<bool(const WriterSubmessage&)>& refused = {});

/// Maximum range of a heartbeat or a gap, and of an acknowledgement's bitmap [samples]; a session's histories
/// are shorter.
inline constexpr std::int64_t max_sequence_range = 1 << 16;
/// Largest sequence number: reached after thirty years at 1 kHz.
inline constexpr std::int64_t max_sequence_number = std::int64_t{1} << 40;
/// Largest fragmented message [bytes]; a scene's largest object has 1 MB.
inline constexpr std::uint32_t max_sample_bytes = 16u << 20;
/// Smallest fragment [bytes]; those of a session fill datagrams of 1400.
inline constexpr std::uint16_t min_fragment_bytes = 64;

}  // namespace eti::bus
