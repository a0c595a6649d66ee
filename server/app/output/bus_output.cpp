// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/bus_output.hpp"

#include <spdlog/spdlog.h>

#include "common/bus/codec/convert.hpp"
#include "common/bus/security/session_keys.hpp"
#include "common/model/pace.hpp"

namespace eti::app {

namespace {

using bus::make_header;

constexpr std::uint64_t steps_per_state = steps_per_second / 90;
constexpr std::uint64_t steps_per_slow_state = steps_per_second / 30;

constexpr std::chrono::milliseconds liveliness_interval{100};
// Of a state that stands still: who joins sees it within a second, also where one of two is lost.
constexpr std::chrono::milliseconds repeat_interval{400};
// Longer than the lease after which a killed reader is discarded.
constexpr std::chrono::milliseconds shutdown_timeout{2000};

}  // namespace

BusOutput::BusOutput(bus::Node& node, const Scenario& scenario, const patient::Patient& patient,
                     const Laryngoscope& scope, const RuntimeParameters& start)
    : session_(node.options().session),
      description_(node, bus::topics::session_description),
      scene_(node, bus::topics::scene),
      deformation_(node, bus::topics::deformation),
      deformation_slow_(node, bus::topics::deformation_slow),
      live_(node, bus::topics::live_metrics),
      summary_(node, bus::topics::attempt_summary),
      result_(node, bus::topics::command_result),
      shown_(node, bus::topics::shown_annotation),
      status_(node, bus::topics::session_status) {
    if (scenario.saliva) {
        fluid_.emplace(node, bus::topics::fluid);
    }
    if (!description_.publish(description_message(session_, scenario, patient, scope, start))) {
        spdlog::error("cannot publish the session's description; clients and devices will not join it");
    }
    for (msg::SceneDescription& object : scene_messages(patient, scope)) {
        if (!scene_.publish(object)) {
            spdlog::error("cannot publish scene object '{}'; clients will not show the patient",
                          object.object().to_string());
        }
    }
    thread_ = std::thread([this] { run(); });
}

BusOutput::~BusOutput() {
    if (thread_.joinable()) {
        finish({});
    }
}

void BusOutput::post(const scene::Snapshot& snapshot, const StatusValues& status) {
    if (snapshot.step % steps_per_state != 0) {
        return;
    }
    Work& work = newest_step_.draft();
    work.snapshot = snapshot;
    work.status = status;
    skipped_ += newest_step_.post() ? 1 : 0;
    posted_.release();
}

void BusOutput::post_status(const StatusValues& status) {
    newest_status_.write(status);
    posted_.release();
}

void BusOutput::post_live(const scene::Snapshot& snapshot, const AttemptStatus& live) {
    newest_live_.write(live_message(snapshot, live));
    posted_.release();
}

template <class Event>
void BusOutput::push(SpscQueue<Event>& queue, const Event& event) {
    if (!queue.push(event)) {
        lost_.fetch_add(1, std::memory_order_relaxed);
    }
    posted_.release();
}

void BusOutput::post_result(const msg::CommandResult& result) {
    push(results_, result);
}

void BusOutput::post_shown(const std::vector<msg::ShownAnnotation>& annotations) {
    for (const msg::ShownAnnotation& annotation : annotations) {
        push(annotations_, annotation);
    }
}

void BusOutput::post_summary(std::uint32_t attempt, const Outcome& outcome, const AttemptMetrics& metrics) {
    push(summaries_, {attempt, 0, outcome, metrics});
}

void BusOutput::finish(const StatusValues& status) {
    StatusValues last = status;
    last.phase = msg::PHASE_FINISHED;
    newest_status_.write(last);
    ending_.store(true, std::memory_order_release);
    posted_.release();
    thread_.join();
    if (const std::uint64_t lost = lost_.load(std::memory_order_relaxed); lost > 0) {
        spdlog::warn(
            "{} results of commands, annotations or summaries were not sent: more than {} waited. A "
            "reader of this session is stuck; restart it",
            lost, max_waiting);
    }
}

void BusOutput::run() {
    const Work* step = nullptr;
    const msg::LiveMetrics* live = nullptr;
    const StatusValues* status = nullptr;
    bool any_live = false;
    for (bool ending = false; !ending;) {
        posted_.acquire();
        ending = ending_.load(std::memory_order_acquire);  // first, so that nothing is left unread
        const bool new_step = newest_step_.read(step);
        const bool new_status = newest_status_.read(status);
        const bool new_live = newest_live_.read(live);
        any_live = any_live || new_live;
        publish_events(step->snapshot.time_ns);
        // A step leaves before its measures: a reader that has the measures has the rest.
        if (new_step) {
            publish_step(*step);
        }
        if (new_live) {
            live_.publish(*live);
        }
        if (ending || (new_status && !new_step)) {
            publish_status(step->snapshot, *status);
            if (!ending && any_live && status->phase == msg::PHASE_FROZEN &&
                Clock::now() - repeated_ >= repeat_interval) {
                repeat_state(step->snapshot);
                live_.publish(*live);
            }
        }
    }
    // Otherwise a busy reader that has not polled yet would miss the end of the session, and the sender of
    // the command its result.
    if (!status_.wait_until_received(shutdown_timeout) || !summary_.wait_until_received(shutdown_timeout) ||
        !result_.wait_until_received(shutdown_timeout)) {
        spdlog::warn("not every reader has acknowledged the session's end");
    }
}

void BusOutput::publish_events(std::uint64_t time_ns) {
    for (; const msg::CommandResult* const result = results_.front(); results_.pop()) {
        result_.publish(*result);
    }
    for (; const msg::ShownAnnotation* const annotation = annotations_.front(); annotations_.pop()) {
        shown_.publish(*annotation);
    }
    for (; const bus::AttemptReport* const waiting = summaries_.front(); summaries_.pop()) {
        bus::AttemptReport report = *waiting;
        report.ended_ns = time_ns;
        summary_.publish(bus::encode_attempt(report, ++number_));
    }
}

void BusOutput::publish_step(const Work& work) {
    const scene::Snapshot& s = work.snapshot;
    if (s.step < last_step_) {  // a replay was rewound
        next_slow_ = next_status_ = 0;
    }
    // A paused replay repeats its step, or moves to another one to stay there.
    const bool stands = work.status.phase == msg::PHASE_FROZEN;
    if (stands && (s.step != last_step_ || Clock::now() - repeated_ >= repeat_interval)) {
        last_step_ = s.step;
        repeat_state(s);
        publish_status(s, work.status);
        return;
    }
    last_step_ = s.step;
    sent_.make(s, [this](msg::DeformationState& state) { deformation_.publish(state); });
    if (fluid_) {
        fluid_messages(s, [this](msg::FluidState& state) { fluid_->publish(state); });
    }
    // By due step, not by this step's number: it may have replaced another.
    if (s.step >= next_slow_) {
        next_slow_ = (s.step / steps_per_slow_state + 1) * steps_per_slow_state;
        if (deformation_slow_.matched() > 0) {
            sent_slow_.make(s, [this](msg::DeformationState& state) { deformation_slow_.publish(state); });
        }
    }
    if (s.step >= next_status_) {
        next_status_ = (s.step / steps_per_status + 1) * steps_per_status;
        publish_status(s, work.status);
    } else if (Clock::now() - asserted_ >= liveliness_interval) {
        // A server far behind the wall clock is alive, too.
        status_.assert_liveliness();
        asserted_ = Clock::now();
    }
}

void BusOutput::repeat_state(const scene::Snapshot& snapshot) {
    repeated_ = Clock::now();
    sent_.make(
        snapshot, [this](msg::DeformationState& state) { deformation_.publish(state); }, true);
    sent_slow_.make(
        snapshot, [this](msg::DeformationState& state) { deformation_slow_.publish(state); }, true);
    if (fluid_) {
        fluid_messages(snapshot, [this](msg::FluidState& state) { fluid_->publish(state); });
    }
}

void BusOutput::publish_status(const scene::Snapshot& snapshot, const StatusValues& status) {
    msg::SessionStatus message;
    message.session(session_);
    message.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
    message.phase(status.phase);
    message.server(bus::process_name());
    message.load(status.load);
    message.behind_s(status.behind);
    message.laryngoscope(status.laryngoscope);
    message.tube(status.tube);
    status_.publish(message);
    asserted_ = Clock::now();
}

}  // namespace eti::app
