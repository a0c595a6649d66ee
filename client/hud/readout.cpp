// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/readout.hpp"

#include "common/math/units.hpp"

namespace eti::hud {

float blade_depth(const Landmarks& points, const Vec3f& tip) {
    const Vec3f& gum = at(points, Landmark::upper_gum);
    const Vec3f past = tip - gum;
    return past.dot(at(points, Landmark::glottis) - gum) > 0.0f ? past.norm() : 0.0f;
}

Readout readout_of(const view::SceneView& scene, bool server_lost) {
    Readout readout;
    readout.time_s = 1e-9 * static_cast<double>(scene.simulation_time_ns());
    if (const auto& status = scene.status()) {
        readout.link = status->phase() == msg::PHASE_FINISHED ? Link::finished : Link::running;
        readout.server_load = status->load();
        readout.behind_s = status->behind_s();
    }
    if (const auto& description = scene.description()) {
        readout.scenario = description->scenario().to_string();
    }
    if (!scene.complete()) {
        readout.link = Link::waiting;
    }
    if (server_lost && readout.link != Link::finished) {
        readout.link = Link::lost;
    }
    if (const auto& metrics = scene.metrics()) {
        readout.attempt = metrics->attempt();
        readout.attempt_running = metrics->attempt_running();
        readout.gum_force_n = metrics->gum_force_n();
        readout.glottic_opening_percent = metrics->glottic_opening_percent();
        readout.tube_past_cords_cm = metrics->tube_depth_past_glottis() / centimetre;
        readout.tube_force_n = metrics->tube_force_n();
        readout.message = metrics->message().to_string();
    }
    if (scene.keys() && scene.laryngoscope_pose()) {
        const Vec3f tip = *scene.laryngoscope_pose() * scene.keys()->laryngoscope().tip();
        readout.blade_depth_cm = blade_depth(scene.landmarks(), tip) / centimetre;
    }
    return readout;
}

}  // namespace eti::hud
