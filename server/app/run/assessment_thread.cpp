// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/assessment_thread.hpp"

#include <spdlog/spdlog.h>

namespace eti::app {

AssessmentThread::AssessmentThread(Assessor& assessor, Recorder* recorder, BusOutput* output, bool beside)
    : assessor_(assessor), recorder_(recorder), output_(output) {
    if (beside) {
        thread_ = std::thread([this] { run(); });
    }
}

AssessmentThread::~AssessmentThread() {
    if (thread_.joinable()) {
        filled_.release();  // without a step: the end
        thread_.join();
    }
}

void AssessmentThread::submit(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye) {
    if (!thread_.joinable()) {
        assess(snapshot, eye, inputs_);
        inputs_.clear();
        return;
    }
    free_.acquire();
    Step& step = *steps_.back();
    step.snapshot = snapshot;
    step.eye = eye;
    std::swap(step.inputs, inputs_);
    inputs_.clear();
    steps_.push();
    filled_.release();
}

void AssessmentThread::run() {
    for (filled_.acquire(); const Step* const step = steps_.front(); filled_.acquire()) {
        assess(step->snapshot, step->eye, step->inputs);
        steps_.pop();
        free_.release();
    }
}

void AssessmentThread::assess(const scene::Snapshot& snapshot, const std::optional<RigidTransform>& eye,
                              const StepInputs& inputs) {
    assessor_.observe(snapshot, eye ? std::optional(eye->translation) : std::nullopt);
    const metrics::Metrics& metrics = assessor_.metrics();
    if (assessor_.due() && (recorder_ != nullptr || output_ != nullptr || observer_)) {
        // Rocking and smoothness need the whole attempt: computed per view evaluation, not per step.
        metrics_ = metrics.current_metrics();
    }
    if (observer_) {
        fill(observed_step_, snapshot, metrics.live(), metrics_, eye, assessor_.eye());
        observer_(observed_step_);
    }
    if (recorder_ != nullptr) {
        record(inputs);
        recorder_->record(snapshot, metrics.live(), metrics_, eye, assessor_.eye());
        log_events();
    }
    if (metrics.attempts().size() > seen_attempts_) {
        post_summaries();
        last_ended_ = static_cast<double>(snapshot.time_ns) * 1e-9;
    }
    ended_at_.store(metrics.live().attempt_running ? -1.0 : last_ended_, std::memory_order_relaxed);
    if (output_ != nullptr && assessor_.due()) {
        output_->post_live(snapshot, {metrics.live(), metrics_, eye});
    }
}

void AssessmentThread::record(const StepInputs& inputs) {
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

void AssessmentThread::post_summaries() {
    const std::span attempts = assessor_.metrics().attempts();
    for (; seen_attempts_ < attempts.size(); ++seen_attempts_) {
        const metrics::AttemptSummary& a = attempts[seen_attempts_];
        spdlog::info("attempt {} ended after {:.1f} s: {}", a.number, a.ended - a.began, a.outcome.reason);
        if (output_ != nullptr) {
            output_->post_summary(a.number, a.outcome, a.metrics);
        }
        if (recorder_ != nullptr) {
            recorder_->summary(a);
        }
    }
}

void AssessmentThread::log_events() {
    const std::span events = assessor_.metrics().events();
    for (; logged_events_ < events.size(); ++logged_events_) {
        recorder_->event(events[logged_events_].time_ns, "attempt", events[logged_events_].text);
    }
}

void AssessmentThread::finish() {
    if (thread_.joinable()) {
        filled_.release();  // without a step: the end
        thread_.join();
    }
    assessor_.metrics().finish();
    post_summaries();
    const metrics::AttemptSummary run = assessor_.metrics().run();
    if (recorder_ != nullptr) {
        record(inputs_);  // no step followed it
        inputs_.clear();
        log_events();
        recorder_->summary(run);
    }
    if (output_ != nullptr) {
        output_->post_summary(0, run.outcome, run.metrics);
    }
}

}  // namespace eti::app
