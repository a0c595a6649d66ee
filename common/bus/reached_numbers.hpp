// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>

#include "common/bus/rtps_message.hpp"

namespace eti::bus {

/// How far each reliable writer's sequence numbers can have come. Fast DDS 2.9.1 counts one by one from where
/// a reader is to where a heartbeat or a gap says that its writer is, at about two million a second and with
/// the reader's lock held (StatefulReader::NotifyChanges): one heartbeat of 2^30 stops a program for minutes.
/// So a number may rise by what a session's writers write, and no faster. For any thread.
class ReachedNumbers {
  public:
    using Clock = std::chrono::steady_clock;

    /// Whether the writer may be at this number by now; if so, that is noted. Smaller numbers always may.
    [[nodiscard]] bool plausible(const WriterId& writer, std::int64_t number,
                                 Clock::time_point now = Clock::now());

    /// Where a writer may be when first heard: a session's busiest that is always on, its status, gets there
    /// in 39 days. A reader counts to it in 17 s.
    static constexpr std::int64_t first = std::int64_t{1} << 25;
    /// Samples a second; the busiest reliable topic has a hundredth of it in the long run.
    static constexpr std::int64_t per_second = 1000;
    /// Samples at once.
    static constexpr std::int64_t burst = longest_range;
    /// Of more than these, those heard longest ago are forgotten: their next number is again a first one.
    static constexpr std::size_t most_writers = 1024;

  private:
    struct Reached {
        std::int64_t number = 0;
        double left = burst;  // samples that it may go on at once
        Clock::time_point heard;
    };

    std::mutex mutex_;
    std::map<WriterId, Reached> writers_;
};

}  // namespace eti::bus
