// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Detects saliva that is not simulated as it should be: no room for more of it, or so compressed that
/// neighbours had to be ignored.
class SalivaMonitor {
  public:
    /// Checks a step. Returns a message, once per finding; empty if there is nothing new.
    [[nodiscard]] std::string check(const scene::SalivaState& saliva);

  private:
    bool full_ = false, crowded_ = false;
};

}  // namespace eti::app
