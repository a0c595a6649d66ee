// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "server/app/bus_input.hpp"
#include "server/app/simulation.hpp"

namespace eti::app {

/// One word for a kind of command, as in the session file.
[[nodiscard]] std::string_view name_of(msg::CommandKind kind);

/// Carries out commands that came over the bus and words their answers.
class CommandDesk {
  public:
    explicit CommandDesk(PatientLimits limits = {}) : limits_(std::move(limits)) {}

    /// Checks `command` and applies it to `inputs`; the answer is ready afterwards.
    void handle(const ReceivedCommand& command, scene::Inputs& inputs);

    [[nodiscard]] const msg::CommandResult& answer() const { return answer_; }
    /// As last asked for, 0..1.
    [[nodiscard]] float suction() const { return suction_; }
    [[nodiscard]] bool stopped() const { return stopped_; }
    /// Whether a reset was asked for since last asked.
    [[nodiscard]] bool take_reset();

  private:
    // Each returns why not, or nothing.
    [[nodiscard]] static std::string grow_head(float scale, scene::Inputs& inputs);
    [[nodiscard]] std::string grow_tongue(float scale, scene::Inputs& inputs) const;
    [[nodiscard]] std::string stiffen(float modulus, scene::Inputs& inputs) const;
    [[nodiscard]] std::string secrete(float flow, scene::Inputs& inputs) const;

    PatientLimits limits_;
    msg::CommandResult answer_;
    float suction_ = 0.0f;
    bool stopped_ = false;
    bool reset_ = false;
};

}  // namespace eti::app
