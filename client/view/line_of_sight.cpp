// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/line_of_sight.hpp"

#include <algorithm>
#include <cmath>

#include "client/view/pressed.hpp"
#include "client/view/ray.hpp"
#include "common/model/lip_retraction.hpp"

namespace eti::view {
namespace {

// The glottis is an opening of some 3 mm; its rim, just before its centre, hides nothing.
constexpr float short_of_glottis = 1.5e-3f;  // [m]

std::string_view said(Tissue tissue) {
    return tissue == Tissue::soft ? std::string_view("soft tissue") : name_of(tissue);
}

}  // namespace

Sight sight_of(const TraineeEye& eye, const Landmarks& now) {
    return {eye.position(now), at(now, Landmark::glottis)};
}

std::optional<Obstacle> obstacle(const SceneView& scene, const Sight& sight) {
    const Vec3f onward = (sight.to - sight.from).normalized();
    const Vec3f end = sight.to - short_of_glottis * onward;
    const LipRetraction lips = lip_retraction(sight.from, scene.landmarks());
    Ray ray(sight.from, end);
    std::string_view name;
    for (const auto& [surface_name, surface] : scene.surfaces()) {
        const RestSurface& model = surface.model();
        if (is_bone(model.tissue)) {  // inside the body, hidden anyway
            continue;
        }
        const auto vertices = pressed(scene, surface);
        for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = model.mesh.triangles[t];
            const auto corner = [&](std::uint32_t v) { return lips.held_aside(vertices[v].position); };
            if (ray.meets(corner(a), corner(b), corner(c))) {
                name = said(model.triangle_tissue[t]);
            }
        }
    }
    if (const TubeSweep* const tube = scene.tube()) {
        const auto vertices = tube->vertices();
        for (const auto& [a, b, c] : tube->triangles()) {
            if (ray.meets(vertices[a].position, vertices[b].position, vertices[c].position)) {
                name = "tube";
            }
        }
    }
    Vec3f where = ray.end();
    if (scene.laryngoscope() && scene.laryngoscope_pose()) {
        const RigidTransform into_tool = scene.laryngoscope_pose()->inverse();
        const TriangleMesh& mesh = scene.laryngoscope()->mesh;
        Ray held(into_tool * sight.from, into_tool * where);
        for (const auto& [a, b, c] : mesh.triangles) {
            if (held.meets(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
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

Look look_of(const SceneView& scene, const TraineeEye& eye) {
    const Sight sight = sight_of(eye, scene.landmarks());
    return {sight, obstacle(scene, sight)};
}

}  // namespace eti::view
