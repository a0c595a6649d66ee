// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/model/attempt_metrics.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/tools/tools.hpp"
#include "common/scenario/scenario.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Values of the running attempt for the message LiveMetrics.
struct AttemptStatus : metrics::LiveMetrics {
    AttemptMetrics metrics;
    std::optional<RigidTransform> eye{};  ///< of the trainee, if it has been received
};

/// Description of a session, sent once. `start`: runtime parameters at the start of the session.
[[nodiscard]] msg::SessionDescription description_message(const std::string& session,
                                                          const Scenario& scenario,
                                                          const patient::Patient& patient,
                                                          const Laryngoscope& scope,
                                                          const RuntimeParameters& start);

/// Rest shapes of everything drawn: frames, surfaces, laryngoscope.
[[nodiscard]] std::vector<msg::SceneDescription> scene_messages(const patient::Patient& patient,
                                                                const Laryngoscope& scope);

[[nodiscard]] msg::ProxyState proxy_message(const scene::ProxySnapshot& proxy);

/// What a step's tissue and tube do to the hands that hold the tools.
struct HandForces {
    std::uint64_t step = 0, time_ns = 0;
    RigidTransform proxy;
    Vec3f tissue_force, tissue_torque, tube_force, tube_torque;
    std::vector<scene::TissueContact> contacts;

    void assign(const scene::Snapshot& snapshot);
};
/// A uniform subset of the contacts, so that a bounded message still covers the whole blade.
[[nodiscard]] msg::TissueContacts tissue_message(const HandForces& forces);
[[nodiscard]] msg::TubeForce tube_message(const HandForces& forces);

[[nodiscard]] msg::LiveMetrics live_message(const scene::Snapshot& snapshot, const AttemptStatus& live);

/// Frames as last sent on one topic, so that only changes are sent.
class DeformationMessages {
  public:
    /// Calls `send` with each chunk of a state: the frames that have moved since they were last sent, and a
    /// part of a slow full refresh. The first state has all frames, and so has any that is asked to be
    /// `whole`.
    void make(const scene::Snapshot& snapshot, const std::function<void(msg::DeformationState&)>& send,
              bool whole = false);

  private:
    std::vector<FramePose> sent_;
    std::uint32_t refresh_ = 0;  // next frame of the slow full refresh
};

/// Calls `send` with each chunk of the saliva; does nothing without saliva.
void fluid_messages(const scene::Snapshot& snapshot, const std::function<void(msg::FluidState&)>& send);

}  // namespace eti::app
