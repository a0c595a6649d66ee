// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_meshes.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include "client/render/creased_mesh.hpp"
#include "common/math/units.hpp"

namespace eti::render {
namespace {

constexpr float crease_angle = 40.0f * degree;

}  // namespace

void SceneMeshes::rebuild(const view::SceneView& scene) {
    scene_revision_ = scene.scene_revision();
    ready_ = false;
    std::vector<std::shared_ptr<const view::RestSurface>> models;
    for (const auto& [name, surface] : scene.surfaces()) {
        models.push_back(surface.shared_model());
    }
    baking_ = std::async(std::launch::async, [models, rest = scene.rest_landmarks()] {
        Colours colours;
        for (const auto& model : models) {
            colours[model->name] = surface_colours(*model, rest);
        }
        return colours;
    });
    patient_.build(scene);
    blade_.reset();
    if (scene.laryngoscope()) {
        const CreasedMesh mesh = creased(scene.laryngoscope()->mesh, crease_angle);
        const std::vector<VertexColour> steel(mesh.vertices.size(), VertexColour{198, 200, 205, 255});
        blade_.emplace(mesh.triangles, mesh.vertices, steel);
    }
    tube_.reset();
}

void SceneMeshes::take_colours(Baking baking) {
    if (!baking_.valid() ||
        (baking == Baking::go_on && baking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)) {
        return;
    }
    colours_ = baking_.get();
    for (std::size_t part = 0; part < patient_.parts().size(); ++part) {
        patient_.set_colours(part, colours_.at(patient_.parts()[part].name));
    }
    ready_ = true;
}

void SceneMeshes::sync(const view::SceneView& scene, Baking baking) {
    if (!scene.complete()) {
        ready_ = false;
        scene_revision_ = 0;
        return;
    }
    if (scene_revision_ != scene.scene_revision()) {
        rebuild(scene);
    }
    take_colours(baking);
    if (!ready_) {
        return;
    }
    patient_.update(scene);
    if (const view::TubeSweep* sweep = scene.tube()) {
        if (!tube_) {
            tube_.emplace(sweep->triangles());
        }
        if (tube_->revision != sweep->revision()) {
            tube_->upload(sweep->vertices());
            tube_->revision = sweep->revision();
        }
    } else {
        tube_.reset();
    }
}

}  // namespace eti::render
