// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/headset_runtime/script.hpp"

namespace eti::headset_runtime {

/// A session in simulated time: its states, frames and poses as scripted, and every call that the application
/// makes out of order. Each frame waited for advances the time by one display period.
class SimulatedSession {
  public:
    static constexpr XrDuration period = 11'111'111;  // [ns], 90 Hz

    struct Recentred {};
    using Message = std::variant<XrSessionState, Recentred>;

    explicit SimulatedSession(const std::filesystem::path& folder);

    void fault(const std::string& what);
    /// Writes the report, replacing an earlier one.
    void report() const;

    void begin_life() { lost_ = false; }
    [[nodiscard]] bool lost() const { return lost_; }

    void session_made();
    void session_gone();
    [[nodiscard]] XrResult begin_session();
    [[nodiscard]] XrResult end_session();
    [[nodiscard]] XrResult request_exit();
    [[nodiscard]] std::optional<Message> next_message();

    [[nodiscard]] XrResult wait_frame(XrFrameState& frame);
    [[nodiscard]] XrResult begin_frame();
    /// `shown`: the frame has an image for each eye.
    [[nodiscard]] XrResult end_frame(XrTime seen_at, bool shown);

    [[nodiscard]] bool focused() const { return running_ && state_ == XR_SESSION_STATE_FOCUSED; }
    [[nodiscard]] bool running() const { return running_; }
    /// Number of the frame waited for last, from 1.
    [[nodiscard]] int frame() const { return frame_; }
    [[nodiscard]] XrTime seen_at() const { return now_ + period; }
    [[nodiscard]] bool in_frame() const { return begun_; }
    /// View of an eye in the local space at a time; 0: left.
    [[nodiscard]] XrView eye(int which, XrTime when) const;
    /// Aim pose of a hand in the local space now.
    [[nodiscard]] std::optional<RigidTransform> aim(const std::string& hand) const;
    [[nodiscard]] const Script& script() const { return script_; }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] nlohmann::json& report_json() { return report_; }

  private:
    void go(XrSessionState state);
    void apply_event(const std::string& what);
    [[nodiscard]] double frame_at(XrTime when) const;

    std::filesystem::path folder_;
    Script script_;
    nlohmann::json report_;
    int life_ = 0;
    XrTime now_;
    int frame_ = 0;
    bool waited_ = false, begun_ = false, running_ = false, lost_ = false, exit_asked_ = false;
    XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;  // as last reported to the application
    XrSessionState planned_ = XR_SESSION_STATE_UNKNOWN;
    std::deque<Message> messages_;
    Vec3f centre_ = Vec3f::Zero();  // origin of the local space in the room
};

}  // namespace eti::headset_runtime
