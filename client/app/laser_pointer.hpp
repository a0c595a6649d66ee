// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "client/hmd/hand_input.hpp"
#include "client/hmd/panel.hpp"
#include "client/panel/drawing.hpp"

namespace eti::client {

/// Whether a trigger counts as pulled: one that trembles about a single threshold would go on and off.
[[nodiscard]] bool pulled(float trigger, bool already);

/// Points at the instructor's panel in a headset with either hand. A trigger that was pulled while its hand
/// pointed at the panel is the panel's until it is let go, wherever the hand goes meanwhile; any other one
/// stays with what triggers are for.
class LaserPointer {
  public:
    /// `panel`: null while it is hidden. Takes from `hands` the triggers that are the panel's.
    void follow(const hmd::Panel* panel, hmd::HandInput& hands);

    /// In a picture of so many pixels; far outside where no hand points at it.
    [[nodiscard]] panel::Pointer pointer(int width, int height) const;

    /// From a hand to what it points at [m], in the world: one for each hand that is known, while there is a
    /// panel.
    struct Ray {
        Vec3f from, to;
    };
    [[nodiscard]] const std::vector<Ray>& rays() const { return rays_; }

  private:
    enum class Holds { nothing, panel, elsewhere };

    std::array<Holds, 2> holds_{};
    std::size_t leading_ = 1;  // the hand that points: the right one, or which clicked last
    std::optional<hmd::Pointed> at_;
    std::vector<Ray> rays_;
};

}  // namespace eti::client
