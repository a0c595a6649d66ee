// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "common/bus/guard/rtps_message.hpp"

namespace eti::bus {

/// Keeps strangers from speaking for a participant. Announcements are neither encrypted nor signed, even with
/// security, and Fast DDS 2.9.1 believes whichever came last: a goodbye removes a participant
/// (CVE-2023-50257), other addresses divert what is sent to it, and a lease of nothing lets it expire. The
/// first announcement of a participant therefore stands for as long as it is repeated, and goodbyes are
/// ignored: who has left is missed when its lease ends. Thread-safe.
class AnnouncementGuard {
  public:
    using Clock = std::chrono::steady_clock;

    /// Whether the library may have this announcement of a participant, whose datagram it is in.
    [[nodiscard]] bool plausible(const ParticipantId& participant, const Announcement& announcement,
                                 Clock::time_point now = Clock::now());

    /// After which a participant that does not repeat its announcement may change it: more than the lease of
    /// a session's programs, and than the period at which others repeat theirs.
    static constexpr std::chrono::seconds stands_for{30};
    /// Beyond this number, the participants heard longest ago are dropped.
    static constexpr std::size_t max_participants = 256;

  private:
    struct Participant {
        std::vector<std::uint8_t> content;
        Clock::time_point heard;
    };

    std::mutex mutex_;
    std::map<ParticipantId, Participant> participants_;
};

}  // namespace eti::bus
