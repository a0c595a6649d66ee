// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/app/arrival_statistics.hpp"
#include "client/view/moment_queue.hpp"
#include "client/view/scene_view.hpp"
#include "client/view/sight/trainee_eye.hpp"
#include "common/bus/bus.hpp"

namespace eti::client {

/// Short enough to report a lost connection at once, long enough to tolerate a brief stall.
inline constexpr double lost_after_s = 1.0;

/// The client's side of the bus: applies received messages to a SceneView, publishes the trainee's eye.
class SessionInput {
  public:
    enum class Timing : std::uint8_t {
        newest,   ///< the newest message of each topic, for a display
        moments,  ///< all topics at the same simulation time, a little later; for pictures that are kept
    };
    /// `full_rate`: receive deformation at 90 Hz, else at 30 Hz. `publish_eye`: act as the trainee.
    SessionInput(bus::Node& node, bool full_rate, bool publish_eye, Timing timing = Timing::newest);

    /// Applies all messages received.
    void receive_into(view::SceneView& scene);
    /// Waits for a new deformation state or until the timeout.
    void wait(std::chrono::milliseconds timeout);
    /// Publishes the pose of the trainee's eye; does nothing for other clients.
    void publish_eye(const view::SceneView& scene, const view::TraineeEye& eye);

    /// The server has been gone for `lost_after_s`, or silent for `silent_s`.
    [[nodiscard]] bool lost(double silent_s = lost_after_s) const;
    /// Names of the sessions shown so far, in order; consecutive sessions of one scenario are listed once.
    [[nodiscard]] const std::vector<std::string>& scenarios() const { return scenarios_; }
    /// Arrival statistics of the deformation topic.
    [[nodiscard]] const ArrivalStatistics& arrival() const { return arrival_; }
    /// Whether a server is on the bus, even if it has not published its scene yet.
    [[nodiscard]] bool server_on_bus() const { return scene_.matched() > 0; }

  private:
    /// State of the connection to the server.
    enum class Presence {
        none,  ///< no server seen yet
        alive,
        silent,  ///< on the bus, but its loop is stalled
        gone,    ///< was on the bus and left
    };
    void update_presence();
    void receive_states_into(view::SceneView& scene);
    void queue_states_for(view::SceneView& scene);

    ArrivalStatistics arrival_;
    std::optional<view::MomentQueue> moments_;  // with Timing::moments
    std::vector<std::string> scenarios_;
    bus::Subscriber<msg::SessionDescription> description_;
    bus::Subscriber<msg::SceneDescription> scene_;
    bus::Subscriber<msg::DeformationState> deformation_;
    bus::Subscriber<msg::FluidState> fluid_;
    bus::Subscriber<msg::ProxyState> proxy_;
    bus::Subscriber<msg::LiveMetrics> metrics_;
    bus::Subscriber<msg::SessionStatus> status_;
    bus::Subscriber<msg::AttemptSummary> summary_;
    bus::Subscriber<msg::ShownAnnotation> annotation_;
    std::optional<bus::Publisher<msg::EyePose>> eye_;
    std::uint32_t eye_number_ = 0;

    // Reused, so that receiving a message does not allocate.
    msg::SessionDescription description_message_;
    msg::SceneDescription scene_message_;
    msg::DeformationState deformation_message_;
    msg::FluidState fluid_message_;
    msg::ProxyState proxy_message_;
    msg::LiveMetrics metrics_message_;
    msg::SessionStatus status_message_;
    msg::AttemptSummary summary_message_;
    msg::ShownAnnotation annotation_message_;

    Presence presence_ = Presence::none;
    std::chrono::steady_clock::time_point presence_since_ = std::chrono::steady_clock::now();
};

}  // namespace eti::client
