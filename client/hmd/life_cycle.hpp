// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

namespace eti::hmd {

/// Mirrors XrSessionState, so that the life cycle does not depend on OpenXR.
enum class SessionState : std::uint8_t {
    unknown,
    idle,          ///< headset not worn, or used by another program
    ready,         ///< the runtime wants frames
    synchronized,  ///< frames are paced but not visible
    visible,       ///< visible, but a runtime menu lies on top and has the input focus
    focused,
    stopping,
    loss_pending,  ///< the headset is being disconnected
    exiting,       ///< the runtime or the user wants the program to end
};

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
    [[nodiscard]] RequiredCall enter(SessionState state);
    /// Only the first reason counts.
    void end_with(SessionEnd end);
    /// Requests the end of the session. True: the caller must call xrRequestExitSession, and the runtime
    /// will move to the end; otherwise the session ends at once.
    [[nodiscard]] bool request_exit();

    /// Frames must be waited for, begun and ended.
    [[nodiscard]] bool running() const { return running_ && end_ == SessionEnd::none; }
    /// Frames are visible to the user.
    [[nodiscard]] bool visible() const {
        return running() && (state_ == SessionState::visible || state_ == SessionState::focused);
    }
    /// The hands' input belongs to this program.
    [[nodiscard]] bool focused() const { return running() && state_ == SessionState::focused; }
    [[nodiscard]] SessionEnd end() const { return end_; }

  private:
    SessionState state_ = SessionState::unknown;
    bool running_ = false;
    SessionEnd end_ = SessionEnd::none;
};

}  // namespace eti::hmd
