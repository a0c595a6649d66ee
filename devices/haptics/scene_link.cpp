// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/scene_link.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/bus/codec/convert.hpp"
#include "devices/haptics/reports.hpp"
#include "devices/haptics/timing.hpp"

namespace eti::devices {

namespace {

using bus::from_msg;

constexpr std::chrono::milliseconds poll_interval{5};  // for topics that do not notify
// A new session has begun when simulation time falls back by more than late messages explain.
constexpr std::uint64_t session_gap_ns = 500'000'000;
constexpr std::int64_t silence_ns = 500'000'000;  // reported to the user
constexpr std::int64_t pace_window_ns = 250'000'000;
constexpr float max_real_time_factor = 4.0f;

}  // namespace

SceneLink::SceneLink(bus::Node& node, ForceSource feel)
    : node_(node),
      proxy_topic_(node, bus::topics::proxy),
      live_topic_(node, bus::topics::live_metrics),
      description_topic_(node, bus::topics::session_description),
      status_topic_(node, bus::topics::session_status) {
    if (feel == ForceSource::tissue) {
        tissue_topic_.emplace(node, bus::topics::tissue_contacts);
        tissue_topic_->notify(wait_set_);
    } else if (feel == ForceSource::tube) {
        tube_topic_.emplace(node, bus::topics::tube_force);
        tube_topic_->notify(wait_set_);
    }
    proxy_topic_.notify(wait_set_);
    thread_ = std::thread([this] { run(); });
}

SceneLink::~SceneLink() {
    ending_.store(true, std::memory_order_relaxed);
    thread_.join();
}

void SceneLink::post_initial_scene() {
    if (seen_landmarks_ && initial_scene_.blade_length > 0.0f && initial_scene_.grip_to_tip > 0.0f) {
        known_scene_.write(initial_scene_);
    }
}

void SceneLink::run() {
    while (!ending_.load(std::memory_order_relaxed)) {
        // Wake on each message: the server sends the proxy before the tissue's forces are known.
        (void)wait_set_.wait(poll_interval);
        bool changed = take_proxy();
        changed = take_tissue() || changed;
        changed = take_tube() || changed;
        take_description();
        changed = take_live() || changed;
        take_status();
        changed = discard_if_contested() || changed;
        if (changed) {
            newest_.write(state_);
        }
        watch_silence(monotonic_ns());
    }
}

bool SceneLink::discard_if_contested() {
    if (!node_.contested()) {
        return false;
    }
    const bool had = state_.proxy_arrived != 0 || state_.tissue_arrived != 0;
    state_.proxy_arrived = state_.tissue_arrived = 0;
    return had;
}

bool SceneLink::refuse(std::int64_t& arrived) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    arrived = 0;
    return true;
}

bool SceneLink::take_proxy() {
    if (!proxy_topic_.take_latest(proxy_)) {
        return false;
    }
    if (!read_report(proxy_, state_.proxy)) {
        return refuse(state_.proxy_arrived);
    }
    const std::int64_t now = monotonic_ns();
    const std::uint64_t simulation_ns = proxy_.header().simulation_time_ns();
    if (simulation_ns + session_gap_ns < simulation_ns_) {
        ++state_.session;
        pace_arrived_ = 0;
    }
    simulation_ns_ = simulation_ns;
    measure_real_time_factor(simulation_ns, now);
    state_.proxy_arrived = heard_ = now;
    state_.seen.time = static_cast<double>(simulation_ns) * 1e-9;
    state_.seen.proxy = state_.proxy.proxy.pose;
    received_.fetch_add(1, std::memory_order_relaxed);
    return true;
}

void SceneLink::measure_real_time_factor(std::uint64_t simulation_ns, std::int64_t now) {
    const std::int64_t passed = now - pace_arrived_;
    if (pace_arrived_ != 0 && passed < pace_window_ns) {
        return;
    }
    if (pace_arrived_ != 0 && simulation_ns >= pace_simulation_ns_ && passed < 4 * pace_window_ns) {
        const auto simulated = static_cast<double>(simulation_ns - pace_simulation_ns_);
        state_.pace =
            std::min(static_cast<float>(simulated / static_cast<double>(passed)), max_real_time_factor);
    }
    pace_simulation_ns_ = simulation_ns;
    pace_arrived_ = now;
}

bool SceneLink::take_tissue() {
    if (!tissue_topic_ || !tissue_topic_->take_latest(tissue_)) {
        return false;
    }
    if (!read_report(tissue_, state_.tissue)) {
        return refuse(state_.tissue_arrived);
    }
    state_.tissue_arrived = monotonic_ns();
    return true;
}

bool SceneLink::take_tube() {
    if (!tube_topic_ || !tube_topic_->take_latest(tube_)) {
        return false;
    }
    if (!read_report(tube_, state_.tissue)) {
        return refuse(state_.tissue_arrived);
    }
    state_.tissue_arrived = monotonic_ns();
    return true;
}

bool SceneLink::take_live() {
    if (!live_topic_.take_latest(live_)) {
        return false;
    }
    // Without the description, the landmarks' order is unknown.
    if (!keys_) {
        return false;
    }
    const std::optional<Landmarks> landmarks = keys_->landmarks(live_);
    const LiveMeasures measures = keys_->measures(live_);
    if (!landmarks || !bus::is_valid_point(live_.tube_tip()) ||
        !std::isfinite(measures.glottic_opening_percent) ||
        !std::isfinite(measures.tube_depth_past_glottis)) {
        refused_.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    state_.seen.landmarks = *landmarks;
    state_.seen.glottic_opening_percent = measures.glottic_opening_percent;
    state_.seen.tube_tip = from_msg(live_.tube_tip());
    state_.seen.tube_depth_past_glottis = measures.tube_depth_past_glottis;
    initial_scene_.seen = state_.seen;
    initial_scene_.seen.time = static_cast<double>(live_.header().simulation_time_ns()) * 1e-9;
    seen_landmarks_ = true;
    post_initial_scene();
    return true;
}

void SceneLink::take_description() {
    while (description_topic_.take(description_)) {
        std::string why;
        std::optional<bus::SessionKeys> keys = bus::SessionKeys::of(description_, why);
        if (!keys) {
            refused_.fetch_add(1, std::memory_order_relaxed);
            spdlog::warn("invalid description of the session: {}", why);
            continue;
        }
        if (!keys->key_mismatch().empty()) {
            spdlog::warn("{}", keys->key_mismatch());
        }
        state_.blade = keys->laryngoscope().capsules;
        state_.seen.tube_depth_rule = static_cast<float>(tube_depth_by_weight(keys->patient_weight()));
        initial_scene_.blade_length = keys->laryngoscope().blade_length;
        initial_scene_.grip_to_tip = keys->tube().grip_from_tip;
        initial_scene_.tube_curvature = 1.0f / keys->tube().curve_radius;
        post_initial_scene();
        keys_ = std::move(keys);
    }
}

void SceneLink::take_status() {
    while (status_topic_.take(status_)) {
        if (status_.phase() == msg::PHASE_FINISHED) {
            finished_.store(true, std::memory_order_relaxed);
        }
        const bool frozen = status_.phase() == msg::PHASE_FROZEN;
        if (frozen != frozen_) {
            frozen ? spdlog::warn("the session is paused until a silent device is back; forces are off")
                   : spdlog::info("the session continues");
        }
        frozen_ = frozen;
    }
}

void SceneLink::watch_silence(std::int64_t now) {
    if (heard_ == 0) {
        return;
    }
    const bool silent = now - heard_ > silence_ns;
    if (silent && !silent_ && !finished() && !frozen_) {
        outages_.fetch_add(1, std::memory_order_relaxed);
        spdlog::warn("no messages from the server ({}); forces are off until it is back",
                     status_topic_.matched() == 0 ? "it has left" : "it is present but sends nothing");
    } else if (!silent && silent_) {
        spdlog::info("the server is back");
    }
    silent_ = silent && !frozen_;
}

}  // namespace eti::devices
