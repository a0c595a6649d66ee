// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/laser_pointer.hpp"

#include <cfloat>

namespace eti::client {
namespace {

constexpr float trigger_on = 0.5f, trigger_off = 0.3f;
constexpr float ray_length = 1.5f;  // [m], of a hand that points elsewhere

}  // namespace

bool pulled(float trigger, bool already) {
    return trigger >= (already ? trigger_off : trigger_on);
}

void LaserPointer::follow(const hmd::Panel* panel, hmd::HandInput& hands) {
    rays_.clear();
    at_.reset();
    std::array<std::optional<hmd::Pointed>, 2> pointed;
    for (std::size_t i = 0; i < holds_.size(); ++i) {
        hmd::Hand& hand = hands.hands[i];
        if (panel != nullptr && hand.aim) {
            pointed[i] = hmd::pointed_at(*panel, *hand.aim);
            const bool inside = pointed[i] && pointed[i]->inside();
            const Vec3f ahead = hand.aim->rotation * Vec3f(-Vec3f::UnitZ());
            rays_.push_back({hand.aim->translation,
                             hand.aim->translation + (inside ? pointed[i]->distance : ray_length) * ahead});
            if (inside && holds_[leading_] != Holds::panel) {
                leading_ = i;
            }
        }
        if (!pulled(hand.trigger, holds_[i] != Holds::nothing)) {
            holds_[i] = Holds::nothing;
        } else if (holds_[i] == Holds::nothing) {
            holds_[i] = pointed[i] && pointed[i]->inside() ? Holds::panel : Holds::elsewhere;
            leading_ = holds_[i] == Holds::panel ? i : leading_;
        }
        hand.trigger = holds_[i] == Holds::panel ? 0.0f : hand.trigger;
    }
    if (pointed[leading_] && (pointed[leading_]->inside() || holds_[leading_] == Holds::panel)) {
        at_ = pointed[leading_];
    }
}

panel::Pointer LaserPointer::pointer(int width, int height) const {
    if (!at_) {
        return {-FLT_MAX, -FLT_MAX, false};
    }
    return {at_->across * static_cast<float>(width), at_->down * static_cast<float>(height),
            holds_[leading_] == Holds::panel};
}

}  // namespace eti::client
