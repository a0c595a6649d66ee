// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/life_cycle.hpp"

namespace eti::hmd {

Duty LifeCycle::enter(SessionState state) {
    if (end_ != SessionEnd::none) {
        return Duty::none;
    }
    state_ = state;
    switch (state) {
        case SessionState::ready:
            if (!running_) {
                running_ = true;
                return Duty::begin_session;
            }
            break;
        case SessionState::stopping:
            if (running_) {
                running_ = false;
                return Duty::end_session;
            }
            break;
        case SessionState::exiting:
            lose(SessionEnd::left);
            break;
        case SessionState::loss_pending:
            lose(SessionEnd::headset_gone);
            break;
        case SessionState::unknown:
        case SessionState::idle:
        case SessionState::synchronized:
        case SessionState::visible:
        case SessionState::focused:
            break;
    }
    return Duty::none;
}

void LifeCycle::lose(SessionEnd end) {
    if (end_ == SessionEnd::none) {
        end_ = end;
    }
}

bool LifeCycle::ask_to_leave() {
    if (running()) {
        return true;
    }
    lose(SessionEnd::left);
    return false;
}

}  // namespace eti::hmd
