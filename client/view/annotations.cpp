// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/annotations.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "client/view/scene_view.hpp"
#include "client/view/text.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::view {

std::optional<Annotation> decode(const msg::ShownAnnotation& message, std::string& why) {
    const msg::Annotation& sent = message.what();
    Annotation out{message.header().simulation_time_ns(),
                   sent.kind(),
                   sent.sender().to_string(),
                   sent.text().to_string(),
                   sent.object().to_string(),
                   {}};
    if (!std::ranges::all_of(std::array{out.sender, out.text, out.object}, printable)) {
        why = "a text with control characters";
        return std::nullopt;
    }
    for (const msg::SurfacePlace& place : sent.places()) {
        out.places.push_back({place.triangle(), place.u(), place.v(), place.height()});
        if (!out.places.back().is_valid()) {
            why = "a place that is not on its triangle";
            return std::nullopt;
        }
    }
    const std::size_t places = out.places.size();
    const bool fits = out.kind == msg::ANNOTATION_POINT    ? places == 1
                      : out.kind == msg::ANNOTATION_STROKE ? places >= 2
                                                           : true;
    if (!fits) {
        why = fmt::format("{} places", places);
        return std::nullopt;
    }
    return out;
}

std::optional<Vec3f> current_position(const SceneView& scene, const std::string& object,
                                      const SurfacePlace& place) {
    const auto at = [&](const TriangleMesh& mesh, const auto& corner) -> std::optional<Vec3f> {
        if (place.triangle >= mesh.triangles.size()) {
            return std::nullopt;
        }
        const auto& [a, b, c] = mesh.triangles[place.triangle];
        return point_at(place, corner(a), corner(b), corner(c));
    };
    if (object == laryngoscope_object) {
        if (!scene.laryngoscope() || !scene.laryngoscope_pose()) {
            return std::nullopt;
        }
        const TriangleMesh& mesh = scene.laryngoscope()->mesh;
        return at(mesh,
                  [&](std::uint32_t v) -> Vec3f { return *scene.laryngoscope_pose() * mesh.vertices[v]; });
    }
    const RestSurface* const surface = scene.rest_surface(object);
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
