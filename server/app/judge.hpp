// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include "common/session/record.hpp"
#include "server/app/bus_output.hpp"
#include "server/app/recorder.hpp"
#include "server/app/simulation.hpp"

namespace eti::app {

/// What comes after a step and not before the next: looks, measures, records and tells, beside the physics
/// thread on one of its own, or at once in the caller where something waits for what was seen. Steps are
/// judged one by one in their order, so that either way gives the same numbers and the same record.
class Judge {
  public:
    /// Steps that may wait to be judged: 0.18 s and some 3 MB.
    static constexpr std::size_t most_waiting = 32;

    /// `recorder` and `output` may be null; all have to outlive it.
    Judge(Assessor& assessor, Recorder* recorder, BusOutput* output, bool beside);
    ~Judge();
    Judge(const Judge&) = delete;
    Judge& operator=(const Judge&) = delete;

    /// A command that acts from the next step on, the state after it, or an event that comes with it: into
    /// the record.
    void note(session::CommandRecord command) { inputs_.commands.push_back(std::move(command)); }
    void note(session::StateRecord state) { inputs_.states.push_back(std::move(state)); }
    void note(session::EventRecord event) { inputs_.events.push_back(std::move(event)); }
    void note(session::AnnotationRecord annotation) { inputs_.annotations.push_back(std::move(annotation)); }
    /// Has `watcher` see each step as it is recorded, with or without a recorder. Before the first step.
    void watch(std::function<void(const session::StepRecord&)> watcher) { watcher_ = std::move(watcher); }
    /// Takes in the next step. Beside: copies it, and waits only while `most_waiting` others do, for none may
    /// be left out.
    void take(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye);
    /// Judges what waits and ends the run and its record but for closing the file. From then on the assessor
    /// is the caller's again.
    void finish();

    /// [s], simulation time at which the last attempt ended; negative before that, and while another goes on.
    [[nodiscard]] double ended_at() const { return ended_at_.load(std::memory_order_relaxed); }

  private:
    /// What came with a step.
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
    void judge(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye,
               const StepInputs& inputs);
    void tell(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye);
    void keep(const StepInputs& inputs);
    void note_events();
    void post_summaries();

    Assessor& assessor_;
    Recorder* recorder_;
    BusOutput* output_;
    std::function<void(const session::StepRecord&)> watcher_;
    session::StepRecord watched_;
    StepInputs inputs_;  // of the step to come

    Parameters parameters_;          // newest live values, for the record
    std::size_t noted_ = 0;          // events already in the record
    std::size_t seen_attempts_ = 0;  // that have ended
    double last_ended_ = -1.0;       // [s], simulation time
    std::atomic<double> ended_at_{-1.0};

    // One thread puts in, one takes out.
    std::array<Step, most_waiting> steps_;
    std::counting_semaphore<most_waiting> free_{most_waiting};
    std::counting_semaphore<> filled_{0};
    std::size_t put_ = 0, taken_ = 0;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::app
