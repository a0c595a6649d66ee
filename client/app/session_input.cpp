// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_input.hpp"

#include <algorithm>

#include "common/bus/codec/convert.hpp"
#include "common/model/pace.hpp"

namespace eti::client {

namespace {

// For moments: messages that wait while a software rasteriser draws, some seconds.
constexpr int queued_samples = 1024;

template <class Message>
bus::Topic<Message> queued(bus::Topic<Message> topic, SessionInput::Timing timing) {
    if (timing == SessionInput::Timing::moments) {
        topic.qos.depth = std::max(topic.qos.depth, queued_samples);
    }
    return topic;
}

}  // namespace

SessionInput::SessionInput(bus::Node& node, bool full_rate, bool publish_eye, Timing timing)
    : arrival_(full_rate ? steps_per_second / 90 : steps_per_second / 30),
      description_(node, bus::topics::session_description),
      scene_(node, bus::topics::scene),
      deformation_(node, full_rate ? bus::topics::deformation : bus::topics::deformation_slow),
      fluid_(node, queued(bus::topics::fluid, timing)),
      proxy_(node, queued(bus::topics::proxy, timing)),
      metrics_(node, queued(bus::topics::live_metrics, timing)),
      status_(node, bus::topics::session_status),
      summary_(node, bus::topics::attempt_summary),
      annotation_(node, bus::topics::shown_annotation) {
    if (timing == Timing::moments) {
        moments_.emplace();
    }
    if (publish_eye) {
        eye_.emplace(node, bus::topics::eye_pose);
    }
}

void SessionInput::receive_into(view::SceneView& scene) {
    const auto take_all = [&](auto& topic, auto& message) {
        while (topic.take(message)) {
            scene.apply(message);
        }
    };
    while (description_.take(description_message_)) {
        const std::string scenario = description_message_.scenario().to_string();
        if (scene.apply(description_message_) && (scenarios_.empty() || scenarios_.back() != scenario)) {
            scenarios_.push_back(scenario);
        }
    }
    take_all(scene_, scene_message_);
    take_all(status_, status_message_);
    moments_ ? queue_states_for(scene) : receive_states_into(scene);
    // After the topics that carry time, since a restarted run discards the previous outcome. Queued until
    // the session's description arrives, as these messages are sent only once.
    if (scene.keys()) {
        take_all(summary_, summary_message_);
        take_all(annotation_, annotation_message_);
    }
    update_presence();
}

void SessionInput::receive_states_into(view::SceneView& scene) {
    while (deformation_.take(deformation_message_)) {
        arrival_.note(deformation_message_.header(), bus::wall_clock_ns());
        scene.apply(deformation_message_);
    }
    while (fluid_.take(fluid_message_)) {
        scene.apply(fluid_message_);
    }
    if (proxy_.take_latest(proxy_message_)) {
        scene.apply(proxy_message_);
    }
    if (metrics_.take_latest(metrics_message_)) {
        scene.apply(metrics_message_);
    }
}

void SessionInput::queue_states_for(view::SceneView& scene) {
    const auto now = view::MomentQueue::Clock::now();
    // Measures first: the states of their time were sent, and thus have arrived, before them.
    while (scene.keys() && metrics_.take(metrics_message_)) {
        moments_->add(metrics_message_, now);
    }
    while (deformation_.take(deformation_message_)) {
        arrival_.note(deformation_message_.header(), bus::wall_clock_ns());
        moments_->add(deformation_message_, now);
    }
    while (fluid_.take(fluid_message_)) {
        moments_->add(fluid_message_, now);
    }
    while (proxy_.take(proxy_message_)) {
        moments_->add(proxy_message_, now);
    }
    moments_->release_into(scene, now);
}

void SessionInput::wait(std::chrono::milliseconds timeout) {
    (void)deformation_.wait(timeout);
}

void SessionInput::publish_eye(const view::SceneView& scene, const view::TraineeEye& eye) {
    if (!eye_ || !scene.complete()) {
        return;
    }
    msg::EyePose message;
    message.header(bus::make_header(scene.simulation_time_ns(), ++eye_number_));
    message.pose(bus::to_msg(eye.pose(scene.landmarks())));
    eye_->publish(message);
}

void SessionInput::update_presence() {
    Presence now = presence_;
    if (status_.alive()) {
        now = Presence::alive;
    } else if (presence_ != Presence::none) {
        now = status_.matched() > 0 ? Presence::silent : Presence::gone;
    }
    if (now != presence_) {
        presence_ = now;
        presence_since_ = std::chrono::steady_clock::now();
    }
}

bool SessionInput::lost(double silent_s) const {
    const std::chrono::duration<double> lasted = std::chrono::steady_clock::now() - presence_since_;
    return (presence_ == Presence::gone && lasted.count() > lost_after_s) ||
           (presence_ == Presence::silent && lasted.count() > silent_s);
}

}  // namespace eti::client
