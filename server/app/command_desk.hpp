// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <utility>

#include "common/model/live.hpp"
#include "server/app/bus_input.hpp"
#include "server/app/simulation.hpp"

namespace eti::app {

/// Carries out commands that came over the bus and words their answers.
class CommandDesk {
  public:
    /// `start`: what lives, as nobody has asked for anything else. `followed`: another session comes after
    /// this one.
    explicit CommandDesk(PatientLimits limits = {}, const LiveValues& start = {}, bool followed = false)
        : limits_(std::move(limits)), wanted_(start), followed_(followed) {}

    /// Checks `command` and takes it; the answer is ready afterwards.
    void handle(const ReceivedCommand& command);

    /// Takes `command`; returns why not, or nothing.
    [[nodiscard]] std::string take(const ReceivedCommand& command);

    /// Words the answer to one that a later one of its kind replaced before its turn.
    void pass_over(const ReceivedCommand& command);

    [[nodiscard]] const msg::CommandResult& answer() const { return answer_; }
    /// What lives, as last asked for.
    [[nodiscard]] const LiveValues& wanted() const { return wanted_; }
    [[nodiscard]] bool stopped() const { return stopped_; }
    /// The session that follows is asked for.
    [[nodiscard]] bool next() const { return next_; }
    /// Whether a reset was asked for since last asked.
    [[nodiscard]] bool take_reset();

  private:
    // Why not, or nothing.
    [[nodiscard]] std::string refusal_of(const LiveField& field, float value) const;

    PatientLimits limits_;
    LiveValues wanted_;
    msg::CommandResult answer_;
    bool followed_;
    bool stopped_ = false;
    bool next_ = false;
    bool reset_ = false;
};

}  // namespace eti::app
