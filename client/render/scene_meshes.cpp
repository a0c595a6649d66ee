// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_meshes.hpp"

#include <algorithm>

#include "client/render/creased_mesh.hpp"
#include "common/math/units.hpp"

namespace eti::render {
namespace {

constexpr float crease_angle = 40.0f * degree;

// Body, then organs, then bones.
int layer(const SurfaceMesh& surface) {
    return surface.tissue == Tissue::soft ? 0 : surface.bone ? 2 : 1;
}

}  // namespace

void SceneMeshes::rebuild(const view::SceneView& scene) {
    surfaces_.clear();
    for (const auto& [name, surface] : scene.surfaces()) {
        const view::RestSurface& model = surface.model();
        std::vector<VertexColour> colours = surface_colours(model, scene.rest_landmarks());
        GpuMesh mesh(model.mesh.triangles, colours);
        surfaces_.push_back({name, model.tissue, is_bone(model.tissue), std::move(colours), std::move(mesh),
                             TriangleBlocks(model.mesh.triangles, model.mesh.vertices)});
    }
    std::stable_sort(surfaces_.begin(), surfaces_.end(),
                     [](const SurfaceMesh& a, const SurfaceMesh& b) { return layer(a) < layer(b); });
    blade_.reset();
    if (scene.laryngoscope()) {
        const CreasedMesh mesh = creased(scene.laryngoscope()->mesh, crease_angle);
        const std::vector<VertexColour> steel(mesh.vertices.size(), VertexColour{198, 200, 205, 255});
        blade_.emplace(mesh.triangles, steel);
        blade_->upload(mesh.vertices);
    }
    tube_.reset();
    scene_revision_ = scene.scene_revision();
}

void SceneMeshes::sync(const view::SceneView& scene) {
    if (!scene.complete()) {
        return;
    }
    if (scene_revision_ != scene.scene_revision()) {
        rebuild(scene);
    }
    for (SurfaceMesh& surface : surfaces_) {
        const auto& shape = scene.surfaces().at(surface.name);
        if (surface.mesh.revision != shape.revision()) {
            surface.mesh.upload(shape.vertices());
            surface.blocks.update(shape.vertices());
            surface.mesh.revision = shape.revision();
        }
    }
    if (const view::TubeSweep* sweep = scene.tube()) {
        if (!tube_) {
            tube_.emplace(sweep->triangles());
        }
        if (tube_->revision != sweep->revision()) {
            tube_->upload(sweep->vertices());
            tube_->revision = sweep->revision();
        }
    }
}

}  // namespace eti::render
