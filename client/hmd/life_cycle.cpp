// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/life_cycle.hpp"

namespace eti::hmd {

RequiredCall LifeCycle::enter(XrSessionState state) {
    if (end_ != SessionEnd::none) {
        return RequiredCall::none;
    }
    state_ = state;
    switch (state) {
        case XR_SESSION_STATE_READY:
            if (!running_) {
                running_ = true;
                return RequiredCall::begin_session;
            }
            break;
        case XR_SESSION_STATE_STOPPING:
            if (running_) {
                running_ = false;
                return RequiredCall::end_session;
            }
            break;
        case XR_SESSION_STATE_EXITING:
            end_with(SessionEnd::left);
            break;
        case XR_SESSION_STATE_LOSS_PENDING:
            end_with(SessionEnd::headset_lost);
            break;
        default:
            break;
    }
    return RequiredCall::none;
}

void LifeCycle::end_with(SessionEnd end) {
    if (end_ == SessionEnd::none) {
        end_ = end;
    }
}

bool LifeCycle::request_exit() {
    if (running()) {
        return true;
    }
    end_with(SessionEnd::left);
    return false;
}

}  // namespace eti::hmd
