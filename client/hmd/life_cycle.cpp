// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/life_cycle.hpp"

namespace eti::hmd {

RequiredCall LifeCycle::enter(SessionState state) {
    if (end_ != SessionEnd::none) {
        return RequiredCall::none;
    }
    state_ = state;
    switch (state) {
        case SessionState::ready:
            if (!running_) {
                running_ = true;
                return RequiredCall::begin_session;
            }
            break;
        case SessionState::stopping:
            if (running_) {
                running_ = false;
                return RequiredCall::end_session;
            }
            break;
        case SessionState::exiting:
            end_with(SessionEnd::left);
            break;
        case SessionState::loss_pending:
            end_with(SessionEnd::headset_lost);
            break;
        case SessionState::unknown:
        case SessionState::idle:
        case SessionState::synchronized:
        case SessionState::visible:
        case SessionState::focused:
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
