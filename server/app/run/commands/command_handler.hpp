// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <utility>

#include "common/model/runtime_parameters.hpp"
#include "server/app/run/bus_input.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::app {

/// Executes commands from the bus and composes their replies.
class CommandHandler {
  public:
    /// `start`: initial runtime parameters. `has_next_session`: another session follows this one.
    explicit CommandHandler(PatientLimits limits = {}, const RuntimeParameters& start = {},
                            bool has_next_session = false)
        : limits_(std::move(limits)), wanted_(start), has_next_session_(has_next_session) {}

    /// Validates and applies `command`; the reply is then in answer().
    void handle(const ReceivedCommand& command);

    /// Applies `command`; returns the reason for rejection, or an empty string.
    [[nodiscard]] std::string apply(const ReceivedCommand& command);

    /// Composes the reply to a command that a later one of its kind replaced.
    void discard(const ReceivedCommand& command);

    [[nodiscard]] const msg::CommandResult& answer() const { return answer_; }
    /// Runtime parameters as last requested.
    [[nodiscard]] const RuntimeParameters& wanted() const { return wanted_; }
    [[nodiscard]] bool stopped() const { return stopped_; }
    /// Whether the next session has been requested.
    [[nodiscard]] bool next() const { return next_; }
    /// Whether a reset has been requested since the last call.
    [[nodiscard]] bool take_reset();

  private:
    // Reason for rejection, or an empty string.
    [[nodiscard]] std::string refusal_of(const RuntimeParameterField& field, float value) const;

    PatientLimits limits_;
    RuntimeParameters wanted_;
    msg::CommandResult answer_;
    bool has_next_session_;
    bool stopped_ = false;
    bool next_ = false;
    bool reset_ = false;
};

}  // namespace eti::app
