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
#include "server/app/scene_messages.hpp"

namespace eti::app {

inline constexpr std::uint64_t steps_per_status = steps_per_second / 10;

struct StatusValues {
    msg::SessionPhase phase = msg::PHASE_RUNNING;
    float load = 0.0f;
    float behind = 0.0f;  ///< [s]
    msg::DevicePresence laryngoscope = msg::DEVICE_NONE, tube = msg::DEVICE_NONE;
};

/// Publishes what is seen and measured from its own thread; the physics thread only leaves copies here and
/// never waits for the network. When publishing is slower than the simulation, the older copy is replaced:
/// every message is a state, not a difference, so nothing is lost but smoothness.
class BusOutput {
  public:
    /// `start`: what lives, as the session begins.
    BusOutput(bus::Node& node, const Scenario& scenario, const anatomy::Patient& patient,
              const Laryngoscope& scope, const LiveValues& start);
    ~BusOutput();
    BusOutput(const BusOutput&) = delete;
    BusOutput& operator=(const BusOutput&) = delete;

    /// Of each step; what is drawn leaves in every second.
    void post(const scene::Snapshot& snapshot, const StatusValues& status);
    /// While no step is taken.
    void post_status(const StatusValues& status);
    /// Of each look.
    void post_live(const scene::Snapshot& snapshot, const LiveMeasures& live);
    void post_result(msg::CommandResult result);
    void post_shown(std::vector<msg::ShownAnnotation> annotations);
    void post_summary(std::uint32_t attempt, const Outcome& outcome, const Parameters& parameters);
    /// Sends what waits, with the phase FINISHED, and ends the thread.
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
        Parameters parameters;
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
    std::optional<bus::Publisher<msg::FluidState>> fluid_;  // only with secretions
    bus::Publisher<msg::LiveMetrics> live_;
    bus::Publisher<msg::AttemptSummary> summary_;
    bus::Publisher<msg::CommandResult> result_;
    bus::Publisher<msg::ShownAnnotation> shown_;
    bus::Publisher<msg::SessionStatus> status_;

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    Work waiting_, current_;
    std::optional<msg::LiveMetrics> waiting_live_;
    std::optional<StatusValues> waiting_status_;  // without a step
    std::deque<msg::CommandResult> results_;
    std::deque<Summary> summaries_;
    std::deque<msg::ShownAnnotation> annotations_;
    bool ending_ = false;
    std::uint64_t skipped_ = 0;
    Clock::time_point asserted_{};  // that this process is alive

    DeformationMessages sent_, sent_slow_;
    std::uint64_t last_step_ = 0, next_slow_ = 0, next_status_ = 0;
    std::uint32_t number_ = 0;  // of what does not come with a step
    std::thread thread_;
};

}  // namespace eti::app
