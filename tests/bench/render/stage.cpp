// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/stage.hpp"

#include <stdexcept>

#include "server/app/scene_messages.hpp"

namespace eti::bench {

namespace {

template <typename Message>
void give(view::SceneView& scene, const Message& message) {
    if (!scene.apply(message)) {
        throw std::runtime_error("the client refuses a message of the server; its log says which and why");
    }
}

}  // namespace

view::SceneView staged(const Attempt& attempt) {
    view::SceneView scene;
    give(scene,
         app::description_message("render", attempt.scenario, attempt.patient, attempt.scope, attempt.start));
    for (const msg::SceneDescription& object : app::scene_messages(attempt.patient, attempt.scope)) {
        give(scene, object);
    }
    return scene;
}

view::SceneView staged(const view::SceneView& rest, const Moment& moment) {
    view::SceneView scene = rest;
    scene::Snapshot s = moment.snapshot;
    // What is drawn over the scene as an aid, such as the glottis's tint, is not measured.
    for (const LiveField& field : live_fields) {
        s.live.*field.value = field.on_off ? 0.0f : s.live.*field.value;
    }
    app::DeformationMessages().make(s, [&](const msg::DeformationState& state) { give(scene, state); });
    if (s.saliva.on) {
        app::fluid_messages(s, [&](const msg::FluidState& state) { give(scene, state); });
    }
    give(scene, app::proxy_message(s));
    app::LiveMeasures measures;
    measures.glottic_opening_percent = moment.opening_percent;
    give(scene, app::live_message(s, measures));
    scene.update();
    return scene;
}

}  // namespace eti::bench
