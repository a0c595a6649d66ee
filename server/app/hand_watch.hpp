// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Notices where a hand does what none does to a newborn: most often a script that leads it through bone.
class HandWatch {
  public:
    /// [m]; a laryngoscope that the shell stops is farther than this from the hand's only where the hand
    /// pushes on. Its device has long reached its limit: 7.9 N at 800 N/m (CouplingSettings).
    static constexpr float farthest = 10e-3f;
    /// [N]; more than any hand: the means of the largest forces in Table 2 of Xiao et al. 2020 are 3.1 to
    /// 5.3 N, and a Miller 0 on a mannequin's upper jaw came to 31 N (Anaesthesia 2016, 455 kPa on 68 mm^2).
    static constexpr double hardest = 50.0;

    /// What there is to say after this step, of each finding once; empty where there is nothing new. `stage`
    /// is the script's, empty where no script holds the laryngoscope.
    [[nodiscard]] std::string look(const scene::Snapshot& snapshot, std::string_view stage);

  private:
    bool parted_ = false, pressed_ = false;
};

}  // namespace eti::app
