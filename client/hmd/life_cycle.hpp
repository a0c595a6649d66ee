// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <cstdint>

namespace eti::hmd {

/// The OpenXR call that a state change requires.
enum class RequiredCall : std::uint8_t { none, begin_session, end_session };

/// Why a session ended.
enum class SessionEnd : std::uint8_t {
    none,
    left,          ///< by the user, or because the program requested it
    headset_lost,  ///< another session may follow
    runtime_lost,  ///< another runtime may follow
};

/// What a session may and must do as the runtime moves it from state to state (OpenXR 1.0, 9.2 and 9.3).
class LifeCycle {
  public:
    /// Tolerates skipped and repeated states: a call already made is not required again.
    [[nodiscard]] RequiredCall enter(XrSessionState state);
    /// Only the first reason counts.
    void end_with(SessionEnd end);
    /// Requests the end of the session. True: the caller must call xrRequestExitSession, and the runtime
    /// will move to the end; otherwise the session ends at once.
    [[nodiscard]] bool request_exit();

    /// Frames must be waited for, begun and ended.
    [[nodiscard]] bool running() const { return running_ && end_ == SessionEnd::none; }
    /// Frames are visible to the user.
    [[nodiscard]] bool visible() const {
        return running() && (state_ == XR_SESSION_STATE_VISIBLE || state_ == XR_SESSION_STATE_FOCUSED);
    }
    /// The hands' input belongs to this program.
    [[nodiscard]] bool focused() const { return running() && state_ == XR_SESSION_STATE_FOCUSED; }
    [[nodiscard]] SessionEnd end() const { return end_; }

  private:
    XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
    bool running_ = false;
    SessionEnd end_ = SessionEnd::none;
};

}  // namespace eti::hmd
