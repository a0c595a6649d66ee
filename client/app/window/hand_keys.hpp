// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "client/app/window/window.hpp"
#include "client/hmd/hand_input.hpp"

namespace eti::client {

/// Maps hand controllers to equivalent keys, so that commands, steps and refusals behave as on the
/// keyboard.
class HandKeys {
  public:
    /// Returns key changes since the last call, and repeats of held keys. Releasing the controls releases
    /// every key. The trigger pulled further sets the suction.
    [[nodiscard]] std::vector<KeyEvent> follow(const hmd::HandInput& hands);

  private:
    std::set<char32_t> held_;
};

/// Controls and their actions, for help in the headset and on the command line.
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> hands_help();

}  // namespace eti::client
