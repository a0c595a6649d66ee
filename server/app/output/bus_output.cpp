// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/bus_output.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/bus/codec/convert.hpp"
#include "common/bus/security/session_keys.hpp"
#include "common/model/pace.hpp"

namespace eti::app {

namespace {

using bus::make_header;

constexpr std::uint64_t steps_per_state = steps_per_second / 90;
constexpr std::uint64_t steps_per_slow_state = steps_per_second / 30;

constexpr std::chrono::milliseconds liveliness_interval{100};
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
        spdlog::error("the session's description could not be published; no client or device will follow it");
    }
    for (msg::SceneDescription& object : scene_messages(patient, scope)) {
        if (!scene_.publish(object)) {
            spdlog::error("scene object '{}' could not be published; clients will not see the patient",
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
    {
        const std::scoped_lock lock(mutex_);
        skipped_ += waiting_.fresh ? 1 : 0;
        waiting_.snapshot = snapshot;
        waiting_.status = status;
        waiting_.fresh = true;
    }
    wake_.notify_one();
}

void BusOutput::post_status(const StatusValues& status) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_status_ = status;
    }
    wake_.notify_one();
}

void BusOutput::post_live(const scene::Snapshot& snapshot, const AttemptStatus& live) {
    msg::LiveMetrics message = live_message(snapshot, live);
    {
        const std::scoped_lock lock(mutex_);
        waiting_live_ = std::move(message);
    }
    wake_.notify_one();
}

void BusOutput::post_result(msg::CommandResult result) {
    {
        const std::scoped_lock lock(mutex_);
        results_.push_back(std::move(result));
    }
    wake_.notify_one();
}

void BusOutput::post_shown(std::vector<msg::ShownAnnotation> annotations) {
    {
        const std::scoped_lock lock(mutex_);
        std::ranges::move(annotations, std::back_inserter(annotations_));
    }
    wake_.notify_one();
}

void BusOutput::post_summary(std::uint32_t attempt, const Outcome& outcome, const AttemptMetrics& metrics) {
    {
        const std::scoped_lock lock(mutex_);
        summaries_.push_back({attempt, outcome, metrics});
    }
    wake_.notify_one();
}

void BusOutput::finish(const StatusValues& status) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_.status = status;
        waiting_.status.phase = msg::PHASE_FINISHED;
        ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

std::uint64_t BusOutput::skipped() const {
    const std::scoped_lock lock(mutex_);
    return skipped_;
}

void BusOutput::run() {
    std::deque<msg::CommandResult> results;
    std::deque<Summary> summaries;
    std::deque<msg::ShownAnnotation> annotations;
    std::optional<msg::LiveMetrics> live;
    std::optional<StatusValues> status;
    bool ending = false;
    while (!ending) {
        bool fresh = false;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] {
                return waiting_.fresh || waiting_live_ || waiting_status_ || ending_ || !results_.empty() ||
                       !summaries_.empty() || !annotations_.empty();
            });
            fresh = waiting_.fresh;
            ending = ending_;
            if (fresh || ending) {
                std::swap(current_, waiting_);
                waiting_.fresh = false;
            }
            results.swap(results_);
            summaries.swap(summaries_);
            annotations.swap(annotations_);
            live = std::exchange(waiting_live_, std::nullopt);
            status = std::exchange(waiting_status_, std::nullopt);
        }
        publish_events(results, summaries, annotations);
        if (live) {
            live_.publish(*live);
        }
        if (fresh) {
            publish_step(current_);
        } else if (status && !ending) {
            current_.status = *status;
            publish_status(current_);
        }
        if (ending) {
            publish_status(current_);
            // Otherwise a busy reader that has not polled yet would miss the end of the session, and the
            // sender of the command its result.
            if (!status_.wait_until_received(shutdown_timeout) ||
                !summary_.wait_until_received(shutdown_timeout) ||
                !result_.wait_until_received(shutdown_timeout)) {
                spdlog::warn("not every reader has acknowledged the session's end");
            }
        }
    }
}

void BusOutput::publish_events(std::deque<msg::CommandResult>& results, std::deque<Summary>& summaries,
                               std::deque<msg::ShownAnnotation>& annotations) {
    for (msg::CommandResult& result : results) {
        result_.publish(result);
    }
    results.clear();
    for (msg::ShownAnnotation& annotation : annotations) {
        shown_.publish(annotation);
    }
    annotations.clear();
    for (const Summary& s : summaries) {
        msg::AttemptSummary message;
        message.header(make_header(current_.snapshot.time_ns, ++number_));
        message.attempt(s.attempt);
        message.success(s.outcome.success);
        message.reason(s.outcome.reason);
        message.parameters(bus::to_msg(s.metrics));
        summary_.publish(message);
    }
    summaries.clear();
}

void BusOutput::publish_step(const Work& work) {
    const scene::Snapshot& s = work.snapshot;
    if (s.step < last_step_) {  // a replay was rewound
        next_slow_ = next_status_ = 0;
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
        publish_status(work);
    } else if (Clock::now() - asserted_ >= liveliness_interval) {
        // A server far behind the wall clock is alive, too.
        status_.assert_liveliness();
        asserted_ = Clock::now();
    }
}

void BusOutput::publish_status(const Work& work) {
    msg::SessionStatus message;
    message.session(session_);
    message.header(make_header(work.snapshot.time_ns, static_cast<std::uint32_t>(work.snapshot.step)));
    message.phase(work.status.phase);
    message.server(bus::process_name());
    message.load(work.status.load);
    message.behind_s(work.status.behind);
    message.laryngoscope(work.status.laryngoscope);
    message.tube(work.status.tube);
    status_.publish(message);
    asserted_ = Clock::now();
}

}  // namespace eti::app
