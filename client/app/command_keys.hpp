// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "client/app/special_keys.hpp"
#include "common/model/live.hpp"

namespace eti::client {

/// What a key does to a command's value.
enum class Stroke : std::uint8_t {
    once,  ///< a command without a value
    step,  ///< adds to it, again while the key is held
    flip,  ///< between 0 and 1
    hold,  ///< 1 while the key is held, else 0
};

/// One row of the table of keys that give commands.
struct CommandKey {
    char32_t key;
    std::string_view caption;  ///< of the key, in ASCII
    std::string_view command;  ///< "reset", or a name of common/model/live.hpp
    Stroke stroke;
    float step;  ///< as typed: degrees
    std::string_view help;
};

[[nodiscard]] std::span<const CommandKey> command_keys();

/// The row of a key, or nullptr.
[[nodiscard]] const CommandKey* command_key(char32_t key);

/// What is to be sent.
struct WantedCommand {
    std::string_view name;
    float value = 0.0f;  ///< SI
};

/// Turns keys into commands. Steps go on from what was last asked for, or from what the patient is, when
/// that is longer ago than a patient takes to follow.
class CommandTyping {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// `patient`: what lives, as the server last said. Nothing: the key asks for nothing new.
    [[nodiscard]] std::optional<WantedCommand> press(const CommandKey& key, bool repeated,
                                                     const LiveValues& patient, Time now);
    [[nodiscard]] std::optional<WantedCommand> release(const CommandKey& key);

  private:
    struct Wish {
        float value = 0.0f;
        Time since;
    };
    std::map<std::string_view, Wish> wishes_;  // by the command's name
};

}  // namespace eti::client
