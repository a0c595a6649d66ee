// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/annotations.hpp"

#include "client/view/scene_view.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::view {

std::optional<Vec3f> current_position(const SceneView& scene, const std::string& object,
                                      const SurfacePlace& place) {
    const auto at = [&](const TriangleMesh& mesh, const auto& corner) -> std::optional<Vec3f> {
        if (place.triangle >= mesh.triangles.size()) {
            return std::nullopt;
        }
        const auto& [a, b, c] = mesh.triangles[place.triangle];
        return point_at(place, corner(a), corner(b), corner(c));
    };
    if (object == bus::laryngoscope_object) {
        if (!scene.laryngoscope() || !scene.laryngoscope_pose()) {
            return std::nullopt;
        }
        const TriangleMesh& mesh = *scene.laryngoscope();
        return at(mesh,
                  [&](std::uint32_t v) -> Vec3f { return *scene.laryngoscope_pose() * mesh.vertices[v]; });
    }
    const bus::RestSurface* const surface = scene.rest_surface(object);
    if (surface == nullptr || scene.frame_maps().size() <= surface->highest_frame) {
        return std::nullopt;
    }
    const auto still = [&](std::uint32_t v) {
        return skin_point(surface->mesh.vertices[v], surface->skin[v], scene.frame_maps());
    };
    if (scene.laryngoscope_pose() && scene.keys() && !is_bone(surface->tissue)) {
        const PosedBladeClearanceDeformer give_way{{plate_of(scene.keys()->laryngoscope())},
                                                   *scene.laryngoscope_pose()};
        return at(surface->mesh, [&](std::uint32_t v) -> Vec3f { return give_way(still(v)); });
    }
    return at(surface->mesh, still);
}

}  // namespace eti::view
