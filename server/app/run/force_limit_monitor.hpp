// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Detects tool motion and forces that no hand applies to a newborn; most often a script that drives a tool
/// through bone.
class ForceLimitMonitor {
  public:
    /// [m]. The distance between the hand and a laryngoscope stopped by the shell exceeds this only if the
    /// hand keeps pushing. The device has then long reached its limit: 7.9 N at 800 N/m (CouplingSettings).
    static constexpr float farthest = 10e-3f;
    /// [N]; more than any hand applies: the means of the largest forces in Table 2 of Xiao et al. 2020 are
    /// 3.1 to 5.3 N, and a Miller 0 on a mannequin's upper jaw reached 31 N (Anaesthesia 2016, 455 kPa on 68
    /// mm^2).
    static constexpr double hardest = 50.0;

    /// Checks a step. Returns a message, once per finding; empty if there is nothing new. `stage`: the
    /// script's stage; empty if no script holds the laryngoscope.
    [[nodiscard]] std::string check(const scene::Snapshot& snapshot, std::string_view stage);

  private:
    bool parted_ = false, pressed_ = false;
};

}  // namespace eti::app
