// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/attempt_scene.hpp"

#include <stdexcept>

#include "server/app/output/scene_messages.hpp"

namespace eti::bench {

namespace {

template <typename Message>
void apply_message(view::SceneView& scene, const Message& message) {
    if (!scene.apply(message)) {
        throw std::runtime_error("the client rejects a message of the server; see its log");
    }
}

}  // namespace

view::SceneView scene_of(const Attempt& attempt) {
    view::SceneView scene;
    apply_message(scene, app::description_message("render", attempt.scenario, attempt.patient, attempt.scope,
                                                  attempt.start));
    for (const msg::SceneDescription& object : app::scene_messages(attempt.patient, attempt.scope)) {
        apply_message(scene, object);
    }
    return scene;
}

view::SceneView scene_of(const view::SceneView& rest, const KeyMoment& moment) {
    view::SceneView scene = rest;
    scene::Snapshot s = moment.snapshot;
    // Aids drawn over the scene, such as the glottis's tint, are not measured.
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        s.runtime_parameters.*field.value = field.on_off ? 0.0f : s.runtime_parameters.*field.value;
    }
    app::DeformationMessages().make(s,
                                    [&](const msg::DeformationState& state) { apply_message(scene, state); });
    if (s.saliva.on) {
        app::fluid_messages(s, [&](const msg::FluidState& state) { apply_message(scene, state); });
    }
    apply_message(scene, app::proxy_message(s));
    app::AttemptStatus status;
    status.measures.glottic_opening_percent = moment.opening_percent;
    apply_message(scene, app::live_message(s, status));
    scene.update();
    return scene;
}

}  // namespace eti::bench
