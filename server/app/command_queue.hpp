// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::app {

/// A command as it came in; the server answers every one.
struct ReceivedCommand {
    std::string sender;
    std::uint32_t id = 0;
    std::string name;
    float value = 0.0f;  ///< SI
};

/// So much of something as a sender may do a second, and as many at once after a pause.
class Allowance {
  public:
    using Clock = std::chrono::steady_clock;

    explicit Allowance(double per_second) : per_second_(per_second), left_(per_second) {}
    [[nodiscard]] bool take(Clock::time_point now);

  private:
    double per_second_, left_;
    Clock::time_point last_{};
};

/// The same for each participant; those beyond a bound share one.
class SenderAllowance {
  public:
    explicit SenderAllowance(double per_second) : per_second_(per_second) {}
    [[nodiscard]] bool take(const bus::ParticipantId& from, Allowance::Clock::time_point now);

  private:
    static constexpr std::size_t most_senders = 64;
    double per_second_;
    std::map<bus::ParticipantId, Allowance> senders_;
};

/// Commands that wait to be carried out: of each sender 20 a second at most. Meanwhile a later one takes the
/// place of an earlier one of its kind, as when a slider is dragged, so that nobody's commands pile up and
/// the last one counts.
class CommandQueue {
  public:
    using Clock = Allowance::Clock;
    static constexpr double per_second = 20.0;
    static constexpr std::size_t most_senders = 64;
    static constexpr std::size_t most_kinds = 64;  ///< of one sender

    /// False: it could not be taken in, because there are too many senders or kinds.
    bool put(const bus::ParticipantId& from, ReceivedCommand command);
    /// Those whose turn it is, in the order in which they came.
    [[nodiscard]] std::vector<ReceivedCommand> take_due(Clock::time_point now);
    /// Those that a later one replaced, to be answered; of each sender as many a second as of the others.
    [[nodiscard]] std::vector<ReceivedCommand> take_replaced(Clock::time_point now);
    /// How many were replaced since last asked, and by whom most.
    [[nodiscard]] std::uint64_t take_flood(std::string& sender);

  private:
    struct Waiting {
        ReceivedCommand command;
        std::uint64_t order = 0;
    };
    struct Sender {
        std::map<std::string, Waiting> by_kind;
        Allowance allowed{per_second}, answered{per_second};
        std::vector<ReceivedCommand> replaced;
        std::uint64_t flood = 0;
    };

    std::map<bus::ParticipantId, Sender> senders_;
    std::uint64_t order_ = 0;
};

}  // namespace eti::app
