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

/// Watches calls that return quickly unless something is broken, such as calls into a library. Supports any
/// number of threads; entering and leaving cost two atomic writes. Time is counted in the watchdog's own
/// ticks, so a stopped program or a suspended machine does not count as hung.
class Watchdog {
    static constexpr std::size_t max_calls = 64;

  public:
    /// `stuck` is called once, on the watchdog's thread, when one call has lasted `ticks` times `tick`.
    Watchdog(std::chrono::milliseconds tick, int ticks, std::function<void()> stuck);
    ~Watchdog();
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;

    /// Scope of one watched call. Of more than 64 simultaneous calls, some are not watched.
    class Call {
      public:
        explicit Call(Watchdog& watch);
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
    std::array<std::atomic<std::uint64_t>, max_calls> slots_{};  // number of the call inside; 0: none
    std::atomic<std::uint64_t> calls_{0};
    std::mutex mutex_;
    std::condition_variable ending_;
    bool end_ = false;
    std::thread thread_;
};

}  // namespace eti
