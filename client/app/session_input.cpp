// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_input.hpp"

#include "common/bus/convert.hpp"

namespace eti::client {

SessionInput::SessionInput(bus::Node& node, bool every_state, bool publish_eye)
    : description_(node, bus::topics::session_description),
      scene_(node, bus::topics::scene),
      deformation_(node, every_state ? bus::topics::deformation : bus::topics::deformation_slow),
      fluid_(node, bus::topics::fluid),
      proxy_(node, bus::topics::proxy),
      metrics_(node, bus::topics::live_metrics),
      status_(node, bus::topics::session_status) {
    if (publish_eye) {
        eye_.emplace(node, bus::topics::eye_pose);
    }
}

bool SessionInput::take_into(view::SceneView& scene) {
    bool any = false;
    while (description_.take(description_message_)) {
        scene.apply(description_message_);
        any = true;
    }
    while (scene_.take(scene_message_)) {
        scene.apply(scene_message_);
        any = true;
    }
    while (status_.take(status_message_)) {
        scene.apply(status_message_);
        any = true;
    }
    while (deformation_.take(deformation_message_)) {
        scene.apply(deformation_message_);
        any = true;
    }
    while (fluid_.take(fluid_message_)) {
        scene.apply(fluid_message_);
        any = true;
    }
    if (proxy_.take_latest(proxy_message_)) {
        scene.apply(proxy_message_);
        any = true;
    }
    if (metrics_.take_latest(metrics_message_)) {
        scene.apply(metrics_message_);
        any = true;
    }
    update_presence();
    return any;
}

void SessionInput::wait(std::chrono::milliseconds timeout) {
    (void)deformation_.wait(timeout);
}

void SessionInput::publish_eye(const view::SceneView& scene) {
    if (!eye_ || !scene.complete()) {
        return;
    }
    msg::EyePose message;
    message.header(bus::make_header(scene.simulation_time_ns(), ++eye_number_));
    message.pose(bus::to_msg(render::laryngoscope_camera(scene.landmarks()).pose()));
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

double SessionInput::presence_for_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - presence_since_).count();
}

}  // namespace eti::client
