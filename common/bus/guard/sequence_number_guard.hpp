// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>

#include "common/bus/guard/rtps_message.hpp"

namespace eti::bus {

/// Limits how fast each reliable writer's sequence number may rise. Fast DDS 2.9.1 counts one by one from a
/// reader's position to the number in a heartbeat or a gap (StatefulReader::NotifyChanges). It does so at
/// about two million a second with the reader locked: one heartbeat of 2^30 stops a program for minutes. A
/// number may therefore rise no faster than a session's writers write. Thread-safe.
class SequenceNumberGuard {
  public:
    using Clock = std::chrono::steady_clock;

    /// Whether the writer may have reached this number by now; if so, it is recorded. Smaller numbers are
    /// always plausible. `from_owner`: the writer belongs to the session's server.
    [[nodiscard]] bool plausible(const WriterId& writer, std::int64_t number, bool from_owner,
                                 Clock::time_point now = Clock::now());

    /// Largest number of a writer heard for the first time; a reader counts to it in 33 ms.
    static constexpr std::int64_t max_first = max_sequence_range;
    /// Likewise of the server, which may have run for long: its status, the busiest permanent topic, reaches
    /// it in 39 days. A reader counts to it in 17 s.
    static constexpr std::int64_t max_first_of_owner = std::int64_t{1} << 25;
    /// [samples/s]; a hundred times the long-term rate of the busiest reliable topic.
    static constexpr std::int64_t per_second = 1000;
    /// [samples], at once.
    static constexpr std::int64_t burst = max_sequence_range;
    /// Beyond this number, the writers heard longest ago are dropped: their next number counts as a first
    /// one.
    static constexpr std::size_t max_writers = 1024;

  private:
    struct WriterProgress {
        std::int64_t number = 0;
        double left = burst;  // [samples], remaining burst
        Clock::time_point heard;
    };

    std::mutex mutex_;
    std::map<WriterId, WriterProgress> writers_;
};

}  // namespace eti::bus
