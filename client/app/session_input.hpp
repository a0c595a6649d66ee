// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/app/arrival.hpp"
#include "client/view/scene_view.hpp"
#include "client/view/trainee_eye.hpp"
#include "common/bus/bus.hpp"

namespace eti::client {

/// Whether a server can be heard.
enum class Presence {
    none,  ///< none was ever there
    alive,
    silent,  ///< on the bus, but its loop does not move
    gone,    ///< was there and left the bus
};

/// A lost connection shows at once; a server that only stumbles is not called lost.
inline constexpr double lost_after_s = 1.0;

/// The client's side of the bus: takes what arrives into a SceneView, publishes the trainee's eye.
class SessionInput {
  public:
    /// `every_state`: take shapes at 90 Hz, else at 30 Hz. `publish_eye`: as the trainee.
    SessionInput(bus::Node& node, bool every_state, bool publish_eye);

    /// Takes all that has arrived; true if anything had.
    bool take_into(view::SceneView& scene);
    /// Waits until a new shape arrives or the time is over.
    void wait(std::chrono::milliseconds timeout);
    /// As the trainee: tells the server where the eye is. Else does nothing.
    void publish_eye(const view::SceneView& scene, const view::TraineeEye& eye);

    [[nodiscard]] Presence presence() const { return presence_; }
    /// Since when presence() is what it is [s].
    [[nodiscard]] double presence_for_s() const;
    /// Of the sessions that were shown, one after another; of several of one scenario, one name.
    [[nodiscard]] const std::vector<std::string>& scenarios() const { return scenarios_; }
    /// How shapes arrive.
    [[nodiscard]] const Arrival& arrival() const { return arrival_; }
    /// A server is on the bus, though it may not have published its scene yet.
    [[nodiscard]] bool server_on_bus() const { return scene_.matched() > 0; }

  private:
    void update_presence();

    Arrival arrival_;
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

    // Reused, so that no message allocates anew.
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
