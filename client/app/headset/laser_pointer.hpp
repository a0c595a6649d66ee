// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "client/hmd/hand_input.hpp"
#include "client/hmd/quad.hpp"
#include "client/panel/panel_renderer.hpp"

namespace eti::client {

/// A line [m] from a hand to its target.
struct LaserRay {
    Vec3f from, to;
};

/// Whether a trigger counts as pulled; has hysteresis, so that a trembling finger does not toggle it.
[[nodiscard]] bool trigger_pulled(float trigger, bool already);

/// Points at the instructor's panel with either hand. A trigger pulled while its hand points at the panel
/// belongs to the panel until released, wherever the hand moves; any other trigger keeps its usual
/// function.
class LaserPointer {
  public:
    /// `panel`: null while hidden. Removes from `hands` the triggers that belong to the panel.
    void follow(const hmd::Quad* panel, hmd::HandInput& hands);

    /// Position in a picture of this size [pixels]; far outside if no hand points at the panel.
    [[nodiscard]] panel::Pointer pointer(int width, int height) const;

    /// In the world frame; one for each tracked hand while the panel is shown.
    [[nodiscard]] const std::vector<LaserRay>& rays() const { return rays_; }

  private:
    enum class TriggerOwner { nothing, panel, elsewhere };

    std::array<TriggerOwner, 2> trigger_owner_{};
    std::size_t active_hand_ = 1;  // the pointing hand: the right one, or the last to click
    std::optional<hmd::QuadHit> at_;
    std::vector<LaserRay> rays_;
};

}  // namespace eti::client
