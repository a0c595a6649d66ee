// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/bus_output.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/bus/convert.hpp"
#include "common/bus/fluid_state.hpp"
#include "common/bus/session_keys.hpp"
#include "common/math/units.hpp"
#include "common/model/live.hpp"
#include "common/model/pace.hpp"
#include "server/scene/scene.hpp"

namespace eti::app {

namespace {

using bus::make_header;
using bus::to_msg;

// Every frame is sent again within this many states, so that a late joiner or a lost chunk heals.
constexpr std::uint32_t refresh_states = 45;
// 24 bytes a frame; the first chunk also carries the tube's nodes. Each chunk fits 1300 bytes.
constexpr std::size_t frames_per_chunk = msg::bound::DeformationState_frames;
constexpr std::size_t frames_in_first_chunk = 24;

constexpr std::uint64_t steps_per_state = steps_per_second / 90;
constexpr std::uint64_t steps_per_slow_state = steps_per_second / 30;
constexpr std::uint64_t steps_per_status = steps_per_second / 10;

constexpr std::chrono::milliseconds liveliness_interval{100};
// Longer than the lease after which a killed reader no longer counts.
constexpr std::chrono::milliseconds farewell{2000};

std::uint8_t quantised(float weight) {
    return static_cast<std::uint8_t>(std::lround(weight * 255.0f));
}

std::int16_t quantised_unit(float x) {
    return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767.0f));
}

msg::FrameUpdate frame_update(std::size_t index, const FramePose& pose) {
    msg::FrameUpdate update;
    update.frame(static_cast<std::uint16_t>(index));
    update.qw(quantised_unit(pose.rotation.w()));
    update.qx(quantised_unit(pose.rotation.x()));
    update.qy(quantised_unit(pose.rotation.y()));
    update.qz(quantised_unit(pose.rotation.z()));
    update.x(pose.centre.x());
    update.y(pose.centre.y());
    update.z(pose.centre.z());
    return update;
}

void append(std::vector<float>& to, const Vec3f& v) {
    to.insert(to.end(), {v.x(), v.y(), v.z()});
}

}  // namespace

BusOutput::BusOutput(bus::Node& node, const Scenario& scenario, const anatomy::Patient& patient,
                     const Laryngoscope& scope, const LiveValues& start)
    : session_(node.options().session),
      description_(node, bus::topics::session_description),
      scene_(node, bus::topics::scene),
      deformation_(node, bus::topics::deformation),
      deformation_slow_(node, bus::topics::deformation_slow),
      live_(node, bus::topics::live_metrics),
      summary_(node, bus::topics::attempt_summary),
      result_(node, bus::topics::command_result),
      status_(node, bus::topics::session_status) {
    if (scenario.saliva) {
        fluid_.emplace(node, bus::topics::fluid);
    }
    publish_description(scenario, patient, scope, start);
    publish_scene(patient, scope);
    thread_ = std::thread([this] { run(); });
}

BusOutput::~BusOutput() {
    if (thread_.joinable()) {
        finish({});
    }
}

void BusOutput::publish_description(const Scenario& scenario, const anatomy::Patient& patient,
                                    const Laryngoscope& scope, const LiveValues& start) {
    msg::SessionDescription message;
    message.session(session_);
    message.header(make_header(0, 0));
    message.version(ETI_VERSION);
    message.scenario(scenario.name);
    message.description(scenario.description);
    message.scenario_text(scenario.text);
    message.steps_per_second(steps_per_second);
    message.time_limit_s(scenario.time_limit);
    message.patient_weight_kg(patient.weight);
    bus::put_keys(start, message);
    bus::put_tools(scope, scenario.tube, message);
    for (std::size_t i = 0; i < landmark_count; ++i) {
        msg::LandmarkKey& key = message.landmarks().emplace_back();
        key.name(std::string(landmark_names[i]));
        key.rest(to_msg(patient.landmarks[i].rest));
    }
    if (!description_.publish(message)) {
        spdlog::error("the session's description could not be published; no client or device will follow it");
    }
}

void BusOutput::publish_scene(const anatomy::Patient& patient, const Laryngoscope& scope) {
    std::vector<msg::SceneDescription> objects;
    const auto object = [&](std::string name, msg::ObjectKind kind) -> msg::SceneDescription& {
        objects.emplace_back();
        objects.back().object(name);
        objects.back().kind(kind);
        return objects.back();
    };
    msg::SceneDescription& frames = object("frames", msg::OBJECT_FRAMES);
    for (const Vec3f& centre : patient.frame_rest_centre) {
        append(frames.vertices(), centre);
    }
    for (const Surface& surface : patient.surfaces) {
        msg::SceneDescription& o = object(surface.name, msg::OBJECT_SURFACE);
        o.tissue(static_cast<std::uint32_t>(surface.tissue));
        for (const Vec3f& v : surface.mesh.vertices) {
            append(o.vertices(), v);
        }
        for (const Triangle& t : surface.mesh.triangles) {
            o.triangles().insert(o.triangles().end(), t.begin(), t.end());
        }
        for (const Tissue t : surface.triangle_tissue) {
            o.triangle_tissue().push_back(static_cast<std::uint8_t>(t));
        }
        for (const SkinWeights& skin : surface.skin) {
            o.skin_frame().insert(o.skin_frame().end(), skin.frame.begin(), skin.frame.end());
            for (const float w : skin.weight) {
                o.skin_weight().push_back(quantised(w));
            }
        }
    }
    msg::SceneDescription& blade = object("laryngoscope", msg::OBJECT_TOOL);
    const TriangleMesh mesh = laryngoscope_mesh(scope);
    for (const Vec3f& v : mesh.vertices) {
        append(blade.vertices(), v);
    }
    for (const Triangle& t : mesh.triangles) {
        blade.triangles().insert(blade.triangles().end(), t.begin(), t.end());
    }
    for (msg::SceneDescription& o : objects) {
        o.object_count(static_cast<std::uint32_t>(objects.size()));
        o.header(make_header(0, 0));
        if (!scene_.publish(o)) {
            spdlog::error("scene object '{}' could not be published; clients will not see the patient",
                          o.object().to_string());
        }
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

void BusOutput::post_live(const scene::Snapshot& snapshot, const LiveMeasures& live) {
    msg::LiveMetrics message;
    message.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
    message.attempt(live.attempt);
    message.attempt_running(live.attempt_running);
    message.glottic_opening_percent(live.glottic_opening_percent);
    message.gum_force_n(live.gum_force);
    message.tube_depth_past_glottis(live.tube_depth_past_glottis);
    message.tube_force_n(snapshot.tube_force.norm());
    message.tube_tip(to_msg(snapshot.tube_nodes.empty() ? Vec3f(Vec3f::Zero()) : snapshot.tube_nodes.back()));
    bus::put_live(snapshot.live, message);
    for (const Vec3f& p : snapshot.landmarks) {
        message.landmarks().push_back(to_msg(p));
    }
    message.parameters(bus::to_msg(live.parameters));
    message.message(live.message);
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

void BusOutput::post_summary(std::uint32_t attempt, const Outcome& outcome, const Parameters& parameters) {
    {
        const std::scoped_lock lock(mutex_);
        summaries_.push_back({attempt, outcome, parameters});
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
    std::optional<msg::LiveMetrics> live;
    std::optional<StatusValues> status;
    bool ending = false;
    while (!ending) {
        bool fresh = false;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] {
                return waiting_.fresh || waiting_live_ || waiting_status_ || ending_ || !results_.empty() ||
                       !summaries_.empty();
            });
            fresh = waiting_.fresh;
            ending = ending_;
            if (fresh || ending) {
                std::swap(current_, waiting_);
                waiting_.fresh = false;
            }
            results.swap(results_);
            summaries.swap(summaries_);
            live = std::exchange(waiting_live_, std::nullopt);
            status = std::exchange(waiting_status_, std::nullopt);
        }
        publish_events(results, summaries);
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
            // Else a busy reader that has not looked yet would never learn that the session has finished.
            if (!status_.wait_until_received(farewell) || !summary_.wait_until_received(farewell)) {
                spdlog::warn("not every reader has acknowledged the session's end");
            }
        }
    }
}

void BusOutput::publish_events(std::deque<msg::CommandResult>& results, std::deque<Summary>& summaries) {
    for (msg::CommandResult& result : results) {
        result_.publish(result);
    }
    results.clear();
    for (const Summary& s : summaries) {
        msg::AttemptSummary message;
        message.header(make_header(current_.snapshot.time_ns, ++number_));
        message.attempt(s.attempt);
        message.success(s.outcome.success);
        message.reason(s.outcome.reason);
        message.parameters(bus::to_msg(s.parameters));
        summary_.publish(message);
    }
    summaries.clear();
}

void BusOutput::publish_step(const Work& work) {
    const scene::Snapshot& s = work.snapshot;
    publish_deformation(s, deformation_, sent_, refresh_);
    publish_fluid(s);
    // By what is due and not by this step's number: another may have taken its place.
    if (s.step >= next_slow_) {
        next_slow_ = (s.step / steps_per_slow_state + 1) * steps_per_slow_state;
        if (deformation_slow_.matched() > 0) {
            publish_deformation(s, deformation_slow_, sent_slow_, refresh_slow_);
        }
    }
    if (s.step >= next_status_) {
        next_status_ = (s.step / steps_per_status + 1) * steps_per_status;
        publish_status(work);
    } else if (Clock::now() - asserted_ >= liveliness_interval) {
        // A server far behind the clock is alive, too.
        status_.assert_liveliness();
        asserted_ = Clock::now();
    }
}

void BusOutput::publish_deformation(const scene::Snapshot& snapshot,
                                    bus::Publisher<msg::DeformationState>& to, std::vector<FramePose>& sent,
                                    std::uint32_t& refresh) {
    const std::size_t count = snapshot.frames.size();
    const bool first = sent.size() != count;
    sent.resize(count);
    std::vector<std::uint16_t> due;
    const auto per_state = static_cast<std::uint32_t>(count / refresh_states + 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool in_turn = (i + static_cast<std::uint32_t>(count) - refresh) % count < per_state;
        if (first || in_turn || has_moved(sent[i], snapshot.frames[i])) {
            due.push_back(static_cast<std::uint16_t>(i));
            sent[i] = snapshot.frames[i];
        }
    }
    refresh = count > 0 ? (refresh + per_state) % static_cast<std::uint32_t>(count) : 0;
    const std::size_t beyond_first =
        due.size() > frames_in_first_chunk ? due.size() - frames_in_first_chunk : 0;
    const std::size_t chunks = 1 + (beyond_first + frames_per_chunk - 1) / frames_per_chunk;
    std::size_t next = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        msg::DeformationState state;
        state.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
        state.chunk(static_cast<std::uint16_t>(chunk));
        state.chunks(static_cast<std::uint16_t>(chunks));
        if (chunk == 0) {
            for (std::size_t i = 0;
                 i < std::min(msg::bound::DeformationState_tube_nodes, snapshot.tube_nodes.size()); ++i) {
                state.tube_nodes().push_back(to_msg(snapshot.tube_nodes[i]));
            }
        }
        const std::size_t end =
            std::min(due.size(), next + (chunk == 0 ? frames_in_first_chunk : frames_per_chunk));
        for (; next < end; ++next) {
            state.frames().push_back(frame_update(due[next], snapshot.frames[due[next]]));
        }
        to.publish(state);
    }
}

void BusOutput::publish_fluid(const scene::Snapshot& snapshot) {
    const scene::SalivaState& saliva = snapshot.saliva;
    if (!fluid_ || !saliva.on) {
        return;
    }
    const bus::Liquid liquid{saliva.lower, saliva.upper, saliva.spacing, saliva.positions};
    msg::FluidState state;
    state.header(make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
    for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(saliva.positions.size()); ++chunk) {
        bus::put_fluid_chunk(liquid, chunk, state);
        fluid_->publish(state);
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
