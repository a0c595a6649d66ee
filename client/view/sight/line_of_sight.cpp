// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/line_of_sight.hpp"

#include <algorithm>
#include <cmath>

#include "client/view/displaced_vertices.hpp"
#include "client/view/sight/ray.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::view {
namespace {

// The glottis is an opening of about 3 mm; its rim, just in front of its centre, is not an obstacle.
constexpr float short_of_glottis = 1.5e-3f;  // [m]

std::string_view said(Tissue tissue) {
    return tissue == Tissue::soft ? std::string_view("soft tissue") : name_of(tissue);
}

}  // namespace

SightLine sight_line(const TraineeEye& eye, const Landmarks& now) {
    return {eye.position(now), at(now, Landmark::glottis)};
}

std::optional<Obstacle> find_obstacle(const SceneView& scene, const SightLine& sight) {
    const Vec3f onward = (sight.to - sight.from).normalized();
    const Vec3f end = sight.to - short_of_glottis * onward;
    const LipRetraction lips = lip_retraction(sight.from, scene.landmarks());
    Ray ray(sight.from, end);
    std::string_view name;
    for (const auto& [surface_name, surface] : scene.surfaces()) {
        const bus::RestSurface& model = surface.model();
        if (is_bone(model.tissue)) {  // inside the body, always hidden
            continue;
        }
        const auto vertices = displaced_vertices(scene, surface);
        for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = model.mesh.triangles[t];
            const auto corner = [&](std::uint32_t v) { return lips.retract_lips(vertices[v].position); };
            if (ray.intersects(corner(a), corner(b), corner(c))) {
                name = said(model.triangle_tissue[t]);
            }
        }
    }
    if (const TubeSweep* const tube = scene.tube()) {
        const auto vertices = tube->vertices();
        for (const auto& [a, b, c] : tube->triangles()) {
            if (ray.intersects(vertices[a].position, vertices[b].position, vertices[c].position)) {
                name = "tube";
            }
        }
    }
    Vec3f where = ray.end();
    if (scene.laryngoscope() && scene.laryngoscope_pose()) {
        const RigidTransform into_tool = scene.laryngoscope_pose()->inverse();
        const TriangleMesh& mesh = *scene.laryngoscope();
        Ray held(into_tool * sight.from, into_tool * where);
        for (const auto& [a, b, c] : mesh.triangles) {
            if (held.intersects(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
                name = "blade";
            }
        }
        where = *scene.laryngoscope_pose() * held.end();
    }
    if (name.empty()) {
        return std::nullopt;
    }
    return Obstacle{where, name};
}

LineOfSight trace_line_of_sight(const SceneView& scene, const TraineeEye& eye) {
    const SightLine sight = sight_line(eye, scene.landmarks());
    return {sight, find_obstacle(scene, sight)};
}

}  // namespace eti::view
