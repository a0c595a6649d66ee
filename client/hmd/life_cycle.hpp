// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

namespace eti::hmd {

/// Where a runtime says that its session is: XrSessionState, so that the life cycle needs no OpenXR.
enum class SessionState : std::uint8_t {
    unknown,
    idle,          ///< nobody wears the headset, or it is given to another program
    ready,         ///< frames are wanted
    synchronized,  ///< frames are paced, nobody sees them
    visible,       ///< seen, but a menu of the runtime lies over them and has the hands
    focused,
    stopping,
    loss_pending,  ///< the headset is going
    exiting,       ///< the runtime, or whoever wears it, wants the program to end
};

/// What a change of state obliges to call.
enum class Duty : std::uint8_t { none, begin_session, end_session };

/// Why a session is over.
enum class SessionEnd : std::uint8_t {
    none,
    left,          ///< by whoever wears the headset, or because the program asked for it
    headset_gone,  ///< another session may follow
    runtime_gone,  ///< another runtime may follow
};

/// What a session may and must do as the runtime leads it from state to state (OpenXR 1.0, 9.2 and 9.3).
class LifeCycle {
  public:
    /// States that leave some out, or come twice, oblige to nothing that was done already.
    [[nodiscard]] Duty enter(SessionState state);
    /// The first loss counts.
    void lose(SessionEnd end);
    /// The program wants to end. True: the runtime must be asked to, and leads there; else it is over at
    /// once.
    [[nodiscard]] bool ask_to_leave();

    /// Frames must be waited for, begun and ended.
    [[nodiscard]] bool running() const { return running_ && end_ == SessionEnd::none; }
    /// Whoever wears the headset sees them.
    [[nodiscard]] bool visible() const {
        return running() && (state_ == SessionState::visible || state_ == SessionState::focused);
    }
    /// What hands do is meant for this program.
    [[nodiscard]] bool focused() const { return running() && state_ == SessionState::focused; }
    [[nodiscard]] SessionEnd end() const { return end_; }

  private:
    SessionState state_ = SessionState::unknown;
    bool running_ = false;
    SessionEnd end_ = SessionEnd::none;
};

}  // namespace eti::hmd
