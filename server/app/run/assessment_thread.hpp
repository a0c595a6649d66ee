// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include "common/process/threads/spsc_queue.hpp"
#include "common/session/record.hpp"
#include "server/app/output/bus_output.hpp"
#include "server/app/output/recorder.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::app {

/// Work after a step that the next step does not need: view evaluation, metrics, recording and publishing.
/// Runs on its own thread beside physics, or synchronously in the caller where something depends on the view.
/// Steps are assessed one by one, in order, so that both give the same metrics and the same record.
class AssessmentThread {
  public:
    /// Capacity of the queue: 0.18 s and some 3 MB.
    static constexpr std::size_t max_waiting = 32;

    /// `recorder` and `output` may be null; all must outlive it. `beside`: use a thread.
    AssessmentThread(Assessor& assessor, Recorder* recorder, BusOutput* output, bool beside);
    ~AssessmentThread();
    AssessmentThread(const AssessmentThread&) = delete;
    AssessmentThread& operator=(const AssessmentThread&) = delete;

    /// Logs, for the record, a command that takes effect in the next step, the state after that step, or an
    /// event or annotation in it.
    void log(session::CommandRecord command) { inputs_.commands.push_back(std::move(command)); }
    void log(session::StateRecord state) { inputs_.states.push_back(std::move(state)); }
    void log(session::EventRecord event) { inputs_.events.push_back(std::move(event)); }
    void log(session::AnnotationRecord annotation) { inputs_.annotations.push_back(std::move(annotation)); }
    /// Calls `observer` with each step as recorded, with or without a recorder. Set before the first step.
    void set_observer(std::function<void(const session::StepRecord&)> observer) {
        observer_ = std::move(observer);
    }
    /// Submits the next step. With a thread: copies it, and waits only while the queue is full, because no
    /// step may be dropped.
    void submit(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye);
    /// Assesses pending steps, and completes the run and its record without closing the file. Afterwards the
    /// caller may use the assessor again.
    void finish();

    /// Simulation time [s] at which the last attempt ended; negative before the first, and while one is
    /// running.
    [[nodiscard]] double ended_at() const { return ended_at_.load(std::memory_order_relaxed); }

  private:
    /// Records that came with a step.
    struct StepInputs {
        std::vector<session::CommandRecord> commands;
        std::vector<session::StateRecord> states;
        std::vector<session::EventRecord> events;
        std::vector<session::AnnotationRecord> annotations;
        void clear() {
            commands.clear();
            states.clear();
            events.clear();
            annotations.clear();
        }
    };
    struct Step {
        scene::Snapshot snapshot;
        std::optional<RigidTransform> eye;
        StepInputs inputs;
    };

    void run();
    void assess(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye,
                const StepInputs& inputs);
    void record(const StepInputs& inputs);
    void log_events();
    void post_summaries();

    Assessor& assessor_;
    Recorder* recorder_;
    BusOutput* output_;
    std::function<void(const session::StepRecord&)> observer_;
    session::StepRecord observed_step_;
    StepInputs inputs_;  // of the next step

    AttemptMetrics metrics_;         // latest values, for the record
    std::size_t logged_events_ = 0;  // events already recorded
    std::size_t seen_attempts_ = 0;  // completed attempts already handled
    double last_ended_ = -1.0;       // [s], simulation time
    std::atomic<double> ended_at_{-1.0};

    SpscQueue<Step> steps_{max_waiting};
    std::counting_semaphore<max_waiting> free_{max_waiting};
    std::counting_semaphore<> filled_{0};
    std::thread thread_;
};

}  // namespace eti::app
