// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/scene_meshes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "client/render/lighting.hpp"
#include "client/render/mesh/creased_mesh.hpp"
#include "client/render/skin/newborn_skin.hpp"
#include "client/render/tools/laryngoscope_details.hpp"
#include "client/render/tools/tube_connector.hpp"
#include "common/math/units.hpp"

namespace eti::render {
namespace {

constexpr float crease_angle = 40.0f * degree;
// Straight edges are curved in the lamp's shadow map. Edges of at most this fraction of their distance from
// the lamp, and of 0.6 mm [m] beside it, err by a hundredth of it.
constexpr float edge_by_distance = 0.25f, shortest_edge = 0.6e-3f;

using Vertices = std::vector<view::LitVertex>;

// A glass of 0.9 mm radius and 3.4 mm length along the blade.
GpuMesh bulb_mesh(const Vec3f& centre) {
    constexpr std::uint32_t rings = 10, sides = 16;
    constexpr float radius = 0.9e-3f, half_body = 0.8e-3f;
    Vertices vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t ring = 0; ring <= rings; ++ring) {
        const float polar = std::numbers::pi_v<float> * static_cast<float>(ring) / rings;
        for (std::uint32_t side = 0; side < sides; ++side) {
            const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / sides;
            const Vec3f out(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                            std::cos(polar));
            const Vec3f along = (out.z() > 0.0f ? half_body : -half_body) * Vec3f::UnitZ();
            vertices.push_back({centre + along + radius * out, out});
            if (ring < rings) {
                const std::uint32_t here = ring * sides + side, next = ring * sides + (side + 1) % sides;
                triangles.push_back({here, here + sides, next});
                triangles.push_back({next, here + sides, next + sides});
            }
        }
    }
    return {triangles, vertices, std::vector<VertexColour>(vertices.size(), {255, 244, 225, 255})};
}

}  // namespace

void SceneMeshes::rebuild(const view::SceneView& scene) {
    scene_revision_ = scene.scene_revision();
    ready_ = false;
    std::vector<std::shared_ptr<const bus::RestSurface>> models;
    for (const auto& [name, surface] : scene.surfaces()) {
        models.push_back(surface.shared_model());
    }
    baking_ = std::async(std::launch::async, [models, rest = scene.rest_landmarks()] {
        Appearances looks;
        for (const auto& model : models) {
            looks[model->name] = surface_appearance(*model, rest);
        }
        return looks;
    });
    patient_.build(scene);
    blade_.reset();
    blade_details_.reset();
    bulb_.reset();
    Solid spare;
    if (scene.laryngoscope()) {
        const Vec3f lamp = bulb_centre(scene.keys()->laryngoscope().blade_length);
        const CreasedMesh mesh = subdivide_long_edges(
            creased(*scene.laryngoscope(), crease_angle),
            [&](const Vec3f& at) { return std::max(shortest_edge, edge_by_distance * (at - lamp).norm()); });
        const std::vector<VertexColour> steel(mesh.vertices.size(), steel_colour);
        blade_.emplace(mesh.triangles, mesh.vertices, steel);
        const CreasedMesh plain = creased(*scene.laryngoscope(), crease_angle);
        spare = {plain.vertices, std::vector<VertexColour>(plain.vertices.size(), steel.front()),
                 plain.triangles};
        const Solid details = laryngoscope_details(scene.keys()->laryngoscope());
        blade_details_.emplace(details.triangles, details.vertices, details.colours);
        bulb_.emplace(bulb_mesh(lamp));
    }
    room_.build(scene, spare);
    tube_.reset();
}

void SceneMeshes::take_appearances(Baking baking) {
    if (!baking_.valid() || (baking == Baking::in_background &&
                             baking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)) {
        return;
    }
    const Appearances looks = baking_.get();
    for (std::size_t part = 0; part < patient_.parts_with_bones().size(); ++part) {
        patient_.set_appearance(part, looks.at(patient_.parts_with_bones()[part].name));
    }
    ready_ = true;
}

void SceneMeshes::live(const view::SceneView& scene) {
    const double time_s = 1e-9 * static_cast<double>(scene.simulation_time_ns());
    const LiveMeasures& now = scene.measures();
    const auto measured = [](float value) {
        return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
    };
    const std::optional<double> saturation = measured(now.oxygen_saturation_percent);
    circulation_.update(time_s, saturation, measured(now.heart_rate_per_min));
    // As the server ventilates: between attempts, unless the tube is in the oesophagus.
    const auto& metrics = scene.metrics();
    const bool ventilated = saturation && metrics && !metrics->attempt_running() &&
                            metrics->tube_place() != msg::TubePlace::TUBE_IN_OESOPHAGUS;
    breathing_.update(time_s, ventilated);
    patient_.set_inflation(breathing_.inflation(), NewbornSkin(scene.rest_landmarks()).size());
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
    take_appearances(baking);
    if (!ready_) {
        return;
    }
    live(scene);
    patient_.update(scene);
    room_.sync(scene);
    if (const view::TubeSweep* sweep = scene.tube()) {
        if (!tube_) {
            tube_.emplace(sweep->triangles());
            const TubeConnector connector = make_tube_connector(sweep->tube());
            connector_.emplace(connector.triangles);
            connector_->upload(connector.vertices);
        }
        if (tube_->revision != sweep->revision()) {
            tube_->upload(sweep->vertices());
            tube_->revision = sweep->revision();
        }
    } else {
        tube_.reset();
        connector_.reset();
    }
}

}  // namespace eti::render
