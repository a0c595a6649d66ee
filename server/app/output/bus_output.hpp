// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/codec/attempt_report.hpp"
#include "common/model/pace.hpp"
#include "common/process/threads/mailbox.hpp"
#include "common/process/threads/spsc_queue.hpp"
#include "server/app/output/scene_messages.hpp"

namespace eti::app {

inline constexpr std::uint64_t steps_per_status = steps_per_second / 10;

struct StatusValues {
    msg::SessionPhase phase = msg::PHASE_RUNNING;
    float load = 0.0f;
    float behind = 0.0f;  ///< [s]
    msg::DevicePresence laryngoscope = msg::DEVICE_NONE, tube = msg::DEVICE_NONE;
};

/// Publishes states and metrics from its own thread. The threads that post only copy and never wait, neither
/// for the network nor for this thread. If publishing is slower than the simulation, newer states replace
/// older ones: every message is a complete state, so only smoothness is lost. Results, annotations and
/// summaries queue up; beyond max_waiting they are lost, which finish() reports.
///
/// Threads: metrics and summaries come from one thread, everything else from one, perhaps another.
class BusOutput {
  public:
    /// Of a kind; more than a second's commands of all senders that the server distinguishes (64 times 20).
    static constexpr std::size_t max_waiting = 2048;

    /// `start`: runtime parameters at the start of the session.
    BusOutput(bus::Node& node, const Scenario& scenario, const patient::Patient& patient,
              const Laryngoscope& scope, const RuntimeParameters& start);
    ~BusOutput();
    BusOutput(const BusOutput&) = delete;
    BusOutput& operator=(const BusOutput&) = delete;

    /// Posts a step; deformation is sent in every second one.
    void post(const scene::Snapshot& snapshot, const StatusValues& status);
    /// Posts the status while no step is taken. With the phase FROZEN it also repeats the standing state and
    /// its measures, for participants that join meanwhile.
    void post_status(const StatusValues& status);
    /// Posts live metrics, after each view evaluation.
    void post_live(const scene::Snapshot& snapshot, const AttemptStatus& live);
    void post_result(const msg::CommandResult& result);
    void post_shown(const std::vector<msg::ShownAnnotation>& annotations);
    void post_summary(std::uint32_t attempt, const Outcome& outcome, const AttemptMetrics& metrics);
    /// Sends pending messages, with the phase FINISHED, and ends the thread.
    void finish(const StatusValues& status);
    /// States replaced before they were sent. For the thread that posts them.
    [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

  private:
    using Clock = std::chrono::steady_clock;
    struct Work {
        scene::Snapshot snapshot;
        StatusValues status;
    };

    void run();
    template <class Event>
    void push(SpscQueue<Event>& queue, const Event& event);
    void publish_step(const Work& work);
    /// Publishes a state that stands still as a whole, if it is due.
    void repeat_state(const scene::Snapshot& snapshot);
    void publish_status(const scene::Snapshot& snapshot, const StatusValues& status);
    void publish_events(std::uint64_t time_ns);

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

    Mailbox<Work> newest_step_;
    Mailbox<msg::LiveMetrics> newest_live_;
    Mailbox<StatusValues> newest_status_;  // posted without a step
    SpscQueue<msg::CommandResult> results_{max_waiting};
    SpscQueue<bus::AttemptReport> summaries_{max_waiting};
    SpscQueue<msg::ShownAnnotation> annotations_{max_waiting};
    std::counting_semaphore<> posted_{0};
    std::atomic<bool> ending_{false};
    std::atomic<std::uint64_t> lost_{0};  // results, annotations and summaries
    std::uint64_t skipped_ = 0;
    Clock::time_point asserted_{};  // last assertion of liveliness
    Clock::time_point repeated_{};  // last publication of a standing state

    DeformationMessages sent_, sent_slow_;
    std::uint64_t last_step_ = 0, next_slow_ = 0, next_status_ = 0;
    std::uint32_t number_ = 0;  // sequence number of messages without a step
    std::thread thread_;
};

}  // namespace eti::app
