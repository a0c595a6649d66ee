// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/judge.hpp"

#include <spdlog/spdlog.h>

namespace eti::app {

Judge::Judge(Assessor& assessor, Recorder* recorder, BusOutput* output, bool beside)
    : assessor_(assessor), recorder_(recorder), output_(output) {
    if (beside) {
        thread_ = std::thread([this] { run(); });
    }
}

Judge::~Judge() {
    if (thread_.joinable()) {
        ending_.store(true, std::memory_order_release);
        filled_.release();
        thread_.join();
    }
}

void Judge::take(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye) {
    if (!thread_.joinable()) {
        judge(snapshot, eye, inputs_);
        inputs_.clear();
        return;
    }
    free_.acquire();
    Step& step = steps_[put_++ % most_waiting];
    step.snapshot = snapshot;
    step.eye = eye;
    std::swap(step.inputs, inputs_);
    inputs_.clear();
    filled_.release();
}

void Judge::run() {
    while (true) {
        filled_.acquire();
        // What the end released comes after all steps.
        if (ending_.load(std::memory_order_acquire) && taken_ == put_) {
            return;
        }
        const Step& step = steps_[taken_++ % most_waiting];
        judge(step.snapshot, step.eye, step.inputs);
        free_.release();
    }
}

void Judge::judge(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye,
                  const StepInputs& inputs) {
    assessor_.observe(snapshot, eye ? std::optional(eye->translation) : std::nullopt);
    const metrics::Metrics& metrics = assessor_.metrics();
    if (assessor_.due() && (recorder_ != nullptr || output_ != nullptr || watcher_)) {
        // Rocking and smoothness look back over the attempt: once per look, not per step.
        parameters_ = metrics.live_parameters();
    }
    if (watcher_) {
        fill(watched_, snapshot, metrics.live(), parameters_, eye, assessor_.eye());
        watcher_(watched_);
    }
    if (recorder_ != nullptr) {
        keep(inputs);
        recorder_->record(snapshot, metrics.live(), parameters_, eye, assessor_.eye());
        note_events();
    }
    if (metrics.attempts().size() > seen_attempts_) {
        post_summaries();
        last_ended_ = static_cast<double>(snapshot.time_ns) * 1e-9;
    }
    ended_at_.store(metrics.live().attempt_running ? -1.0 : last_ended_, std::memory_order_relaxed);
    if (output_ != nullptr && assessor_.due()) {
        tell(snapshot, eye);
    }
}

void Judge::keep(const StepInputs& inputs) {
    for (const session::CommandRecord& c : inputs.commands) {
        recorder_->command(c.time_ns, c.step, c.kind, c.value, c.sender, c.id);
    }
    for (const session::StateRecord& s : inputs.states) {
        recorder_->state(s);
    }
    for (const session::EventRecord& e : inputs.events) {
        recorder_->event(e.time_ns, e.kind, e.text);
    }
    for (const session::AnnotationRecord& a : inputs.annotations) {
        recorder_->annotation(a);
    }
}

void Judge::tell(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye) {
    const metrics::Live& live = assessor_.metrics().live();
    LiveMeasures values;
    values.attempt = live.attempt;
    values.attempt_running = live.attempt_running;
    values.glottic_opening_percent = live.glottic_opening_percent;
    values.gum_force = live.gum_force;
    values.tube_depth_past_glottis = live.tube_depth_past_glottis;
    values.tube_place = live.tube_place;
    values.message = live.message;
    values.parameters = parameters_;
    values.eye = eye;
    output_->post_live(snapshot, values);
}

void Judge::post_summaries() {
    const std::span attempts = assessor_.metrics().attempts();
    for (; seen_attempts_ < attempts.size(); ++seen_attempts_) {
        const metrics::AttemptSummary& a = attempts[seen_attempts_];
        spdlog::info("attempt {} ended after {:.1f} s: {}", a.number, a.ended - a.began, a.outcome.reason);
        if (output_ != nullptr) {
            output_->post_summary(a.number, a.outcome, a.parameters);
        }
        if (recorder_ != nullptr) {
            recorder_->summary(a);
        }
    }
}

void Judge::note_events() {
    const std::span events = assessor_.metrics().events();
    for (; noted_ < events.size(); ++noted_) {
        recorder_->event(events[noted_].time_ns, "attempt", events[noted_].text);
    }
}

void Judge::finish() {
    if (thread_.joinable()) {
        ending_.store(true, std::memory_order_release);
        filled_.release();
        thread_.join();
    }
    assessor_.metrics().finish();
    post_summaries();
    const metrics::AttemptSummary run = assessor_.metrics().run();
    if (recorder_ != nullptr) {
        keep(inputs_);  // no step came after it
        inputs_.clear();
        note_events();
        recorder_->summary(run);
    }
    if (output_ != nullptr) {
        output_->post_summary(0, run.outcome, run.parameters);
    }
}

}  // namespace eti::app
