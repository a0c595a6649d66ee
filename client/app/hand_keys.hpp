// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "client/app/window.hpp"
#include "client/hmd/hand_input.hpp"

namespace eti::client {

/// Turns what hand controllers do into the keys that ask for the same: commands, their steps and refusals are
/// then those of the keyboard.
class HandKeys {
  public:
    /// What has changed since the last call, and again what is held. Fingers at rest let go of every key. Of
    /// the triggers the one that is pulled further sucks.
    [[nodiscard]] std::vector<KeyEvent> follow(const hmd::HandInput& hands);

  private:
    std::set<char32_t> held_;
};

/// Input and what it asks for, for help on the sheet and on the command line.
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> hands_help();

}  // namespace eti::client
