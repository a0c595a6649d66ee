// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/model/pace.hpp"
#include "server/app/output/scene_messages.hpp"

namespace eti::app {

inline constexpr std::uint64_t steps_per_status = steps_per_second / 10;

struct StatusValues {
    msg::SessionPhase phase = msg::PHASE_RUNNING;
    float load = 0.0f;
    float behind = 0.0f;  ///< [s]
    msg::DevicePresence laryngoscope = msg::DEVICE_NONE, tube = msg::DEVICE_NONE;
};

/// Publishes states and metrics from its own thread. The physics thread only posts copies and never waits for
/// the network. If publishing is slower than the simulation, newer states replace older ones: every message
/// is a complete state, so only smoothness is lost.
class BusOutput {
  public:
    /// `start`: runtime parameters at the start of the session.
    BusOutput(bus::Node& node, const Scenario& scenario, const patient::Patient& patient,
              const Laryngoscope& scope, const RuntimeParameters& start);
    ~BusOutput();
    BusOutput(const BusOutput&) = delete;
    BusOutput& operator=(const BusOutput&) = delete;

    /// Posts a step; deformation is sent in every second one.
    void post(const scene::Snapshot& snapshot, const StatusValues& status);
    /// Posts the status while no step is taken.
    void post_status(const StatusValues& status);
    /// Posts live metrics, after each view evaluation.
    void post_live(const scene::Snapshot& snapshot, const AttemptStatus& live);
    void post_result(msg::CommandResult result);
    void post_shown(std::vector<msg::ShownAnnotation> annotations);
    void post_summary(std::uint32_t attempt, const Outcome& outcome, const AttemptMetrics& metrics);
    /// Sends pending messages, with the phase FINISHED, and ends the thread.
    void finish(const StatusValues& status);
    [[nodiscard]] std::uint64_t skipped() const;  ///< states replaced before they were sent

  private:
    using Clock = std::chrono::steady_clock;
    struct Work {
        scene::Snapshot snapshot;
        StatusValues status;
        bool fresh = false;
    };
    struct Summary {
        std::uint32_t attempt;
        Outcome outcome;
        AttemptMetrics metrics;
    };

    void run();
    void publish_step(const Work& work);
    void publish_status(const Work& work);
    void publish_events(std::deque<msg::CommandResult>& results, std::deque<Summary>& summaries,
                        std::deque<msg::ShownAnnotation>& annotations);

    std::string session_;
    bus::Publisher<msg::SessionDescription> description_;
    bus::Publisher<msg::SceneDescription> scene_;
    bus::Publisher<msg::DeformationState> deformation_, deformation_slow_;
    std::optional<bus::Publisher<msg::FluidState>> fluid_;  // only with saliva
    bus::Publisher<msg::LiveMetrics> live_;
    bus::Publisher<msg::AttemptSummary> summary_;
    bus::Publisher<msg::CommandResult> result_;
    bus::Publisher<msg::ShownAnnotation> shown_;
    bus::Publisher<msg::SessionStatus> status_;

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    Work waiting_, current_;
    std::optional<msg::LiveMetrics> waiting_live_;
    std::optional<StatusValues> waiting_status_;  // posted without a step
    std::deque<msg::CommandResult> results_;
    std::deque<Summary> summaries_;
    std::deque<msg::ShownAnnotation> annotations_;
    bool ending_ = false;
    std::uint64_t skipped_ = 0;
    Clock::time_point asserted_{};  // last assertion of liveliness

    DeformationMessages sent_, sent_slow_;
    std::uint64_t last_step_ = 0, next_slow_ = 0, next_status_ = 0;
    std::uint32_t number_ = 0;  // sequence number of messages without a step
    std::thread thread_;
};

}  // namespace eti::app
