// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "client/app/window/special_keys.hpp"
#include "common/model/runtime_parameters.hpp"

namespace eti::client {

/// Effect of a key on a command's value.
enum class KeyAction : std::uint8_t {
    once,    ///< a command without a value
    step,    ///< adds to the value, repeatedly while the key is held
    toggle,  ///< between 0 and 1
    hold,    ///< the amount while the key is held, else 0
};

/// One row of the table of command keys.
struct CommandKey {
    char32_t key;
    std::string_view caption;  ///< key name, in ASCII
    std::string_view command;  ///< "reset", or a name of common/model/runtime_parameters.hpp
    KeyAction action;
    float amount;  ///< in displayed units, of a step and while held
    std::string_view help;
};

[[nodiscard]] std::span<const CommandKey> command_keys();

/// The row of a key, or nullptr.
[[nodiscard]] const CommandKey* command_key(char32_t key);

/// A command to be sent.
struct CommandRequest {
    std::string_view name;
    float value = 0.0f;  ///< SI
};

/// Turns keys into commands. Steps start from the last requested value, or from the patient's current value
/// if the request is older than the patient takes to follow.
class CommandKeyMapper {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// `patient`: runtime parameters, as last published by the server. nullopt: no command to send.
    [[nodiscard]] std::optional<CommandRequest> press(const CommandKey& key, bool repeated,
                                                      const RuntimeParameters& patient, Time now);
    [[nodiscard]] std::optional<CommandRequest> release(const CommandKey& key);

  private:
    struct PendingValue {
        float value = 0.0f;
        Time since;
    };
    std::map<std::string_view, PendingValue> pending_;  // by command name
};

}  // namespace eti::client
