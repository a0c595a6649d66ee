// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/process/rate_limiter.hpp"

namespace eti::app {

/// A command as received; the server replies to each.
struct ReceivedCommand {
    std::string sender;
    std::uint32_t id = 0;
    std::string name;
    float value = 0.0f;  ///< SI
};

/// A rate limiter per participant; participants beyond max_senders share one.
class SenderRateLimiter {
  public:
    explicit SenderRateLimiter(double per_second) : per_second_(per_second) {}
    [[nodiscard]] bool try_acquire(const bus::ParticipantId& from, RateLimiter::Clock::time_point now);

  private:
    static constexpr std::size_t max_senders = 64;
    double per_second_;
    std::map<bus::ParticipantId, RateLimiter> senders_;
};

/// Queue of commands: at most 20 per second and sender. A later command replaces a pending one of the same
/// kind, as when a slider is dragged, so that the queue stays bounded and the last value counts.
class CommandQueue {
  public:
    using Clock = RateLimiter::Clock;
    static constexpr double per_second = 20.0;
    static constexpr std::size_t max_senders = 64;
    static constexpr std::size_t max_kinds = 64;  ///< per sender

    /// Returns false if there are too many senders or kinds.
    bool put(const bus::ParticipantId& from, ReceivedCommand command);
    /// Commands that are due, in order of arrival.
    [[nodiscard]] std::vector<ReceivedCommand> take_due(Clock::time_point now);
    /// Replaced commands, to be replied to; rate-limited per sender like the others.
    [[nodiscard]] std::vector<ReceivedCommand> take_replaced(Clock::time_point now);
    /// Number of replaced commands since the last call; `sender` receives the sender with most.
    [[nodiscard]] std::uint64_t take_replaced_count(std::string& sender);

  private:
    struct Waiting {
        ReceivedCommand command;
        std::uint64_t order = 0;
    };
    struct Sender {
        std::map<std::string, Waiting> by_kind;
        RateLimiter allowed{per_second}, answered{per_second};
        std::vector<ReceivedCommand> replaced;
        std::uint64_t replaced_count = 0;
    };

    std::map<bus::ParticipantId, Sender> senders_;
    std::uint64_t order_ = 0;
};

}  // namespace eti::app
