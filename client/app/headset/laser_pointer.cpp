// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/laser_pointer.hpp"

#include <cfloat>

namespace eti::client {
namespace {

constexpr float trigger_on = 0.5f, trigger_off = 0.3f;
constexpr float ray_length = 1.5f;  // [m], for a hand that misses the panel

}  // namespace

bool trigger_pulled(float trigger, bool already) {
    return trigger >= (already ? trigger_off : trigger_on);
}

void LaserPointer::follow(const hmd::Quad* panel, hmd::HandInput& hands) {
    rays_.clear();
    at_.reset();
    std::array<std::optional<hmd::QuadHit>, 2> pointed;
    for (std::size_t i = 0; i < trigger_owner_.size(); ++i) {
        hmd::Hand& hand = hands.hands[i];
        if (panel != nullptr && hand.aim) {
            pointed[i] = hmd::intersect_quad(*panel, *hand.aim);
            const bool inside = pointed[i] && pointed[i]->inside();
            const Vec3f ahead = hand.aim->rotation * Vec3f(-Vec3f::UnitZ());
            rays_.push_back({hand.aim->translation,
                             hand.aim->translation + (inside ? pointed[i]->distance : ray_length) * ahead});
            if (inside && trigger_owner_[active_hand_] != TriggerOwner::panel) {
                active_hand_ = i;
            }
        }
        if (!trigger_pulled(hand.trigger, trigger_owner_[i] != TriggerOwner::nothing)) {
            trigger_owner_[i] = TriggerOwner::nothing;
        } else if (trigger_owner_[i] == TriggerOwner::nothing) {
            trigger_owner_[i] =
                pointed[i] && pointed[i]->inside() ? TriggerOwner::panel : TriggerOwner::elsewhere;
            active_hand_ = trigger_owner_[i] == TriggerOwner::panel ? i : active_hand_;
        }
        hand.trigger = trigger_owner_[i] == TriggerOwner::panel ? 0.0f : hand.trigger;
    }
    if (pointed[active_hand_] &&
        (pointed[active_hand_]->inside() || trigger_owner_[active_hand_] == TriggerOwner::panel)) {
        at_ = pointed[active_hand_];
    }
}

panel::Pointer LaserPointer::pointer(int width, int height) const {
    if (!at_) {
        return {-FLT_MAX, -FLT_MAX, false};
    }
    return {at_->across * static_cast<float>(width), at_->down * static_cast<float>(height),
            trigger_owner_[active_hand_] == TriggerOwner::panel};
}

}  // namespace eti::client
