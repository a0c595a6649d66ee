// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/model/live.hpp"
#include "common/model/parameters.hpp"
#include "common/model/tools.hpp"
#include "common/scenario/scenario.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Values that change as the attempt goes on, for LiveMetrics.
struct LiveMeasures {
    std::uint32_t attempt = 0;
    bool attempt_running = false;
    float glottic_opening_percent = 0.0f;
    float gum_force = 0.0f;                 ///< [N]
    float tube_depth_past_glottis = -1.0f;  ///< [m]
    metrics::TubePlace tube_place = metrics::TubePlace::outside;
    Parameters parameters;
    std::string message;
    std::optional<RigidTransform> eye{};  ///< of the trainee, where one has said it
};

/// What a session says of itself, once. `start`: what lives, as the session begins.
[[nodiscard]] msg::SessionDescription description_message(const std::string& session,
                                                          const Scenario& scenario,
                                                          const anatomy::Patient& patient,
                                                          const Laryngoscope& scope, const LiveValues& start);

/// Rest shapes of all that is drawn: frames, surfaces, laryngoscope.
[[nodiscard]] std::vector<msg::SceneDescription> scene_messages(const anatomy::Patient& patient,
                                                                const Laryngoscope& scope);

[[nodiscard]] msg::ProxyState proxy_message(const scene::ProxySnapshot& proxy);

[[nodiscard]] msg::LiveMetrics live_message(const scene::Snapshot& snapshot, const LiveMeasures& live);

/// The frames as readers of one topic have got them so far, so that only what moved is sent again.
class DeformationMessages {
  public:
    /// Calls `send` with each chunk of a state: what moved since it was last sent, and a part of a slow full
    /// refresh. The first state has every frame.
    void make(const scene::Snapshot& snapshot, const std::function<void(msg::DeformationState&)>& send);

  private:
    std::vector<FramePose> sent_;
    std::uint32_t refresh_ = 0;  // next frame of the slow full refresh
};

/// Calls `send` with each chunk of the saliva, if there is any.
void fluid_messages(const scene::Snapshot& snapshot, const std::function<void(msg::FluidState&)>& send);

}  // namespace eti::app
