// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace eti {

/// Watches work that comes back at once unless something is broken: a call into a library. For any number of
/// threads; entering and leaving cost two atomic writes. Time is counted in the watch's own ticks, so that a
/// program that was stopped, or a machine that slept, is not taken for one that hangs.
class StuckWatch {
    static constexpr std::size_t most_inside = 64;

  public:
    /// `stuck` is called once, on the watch's thread, when one call has lasted `ticks` times `tick`.
    StuckWatch(std::chrono::milliseconds tick, int ticks, std::function<void()> stuck);
    ~StuckWatch();
    StuckWatch(const StuckWatch&) = delete;
    StuckWatch& operator=(const StuckWatch&) = delete;

    /// From here to its end is one call. Of more than 64 at once some are not watched.
    class Call {
      public:
        explicit Call(StuckWatch& watch);
        ~Call();
        Call(const Call&) = delete;
        Call& operator=(const Call&) = delete;

      private:
        std::atomic<std::uint64_t>* slot_ = nullptr;
    };

  private:
    void run();

    const std::chrono::milliseconds tick_;
    const int ticks_;
    const std::function<void()> stuck_;
    std::array<std::atomic<std::uint64_t>, most_inside> slots_{};  // number of the call inside; 0: none
    std::atomic<std::uint64_t> calls_{0};
    std::mutex mutex_;
    std::condition_variable ending_;
    bool end_ = false;
    std::thread thread_;
};

}  // namespace eti
