// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/pressed.hpp"

#include "common/model/give_way.hpp"

namespace eti::view {

std::vector<LitVertex> pressed(const SceneView& scene, const SkinnedSurface& surface) {
    std::vector<LitVertex> vertices(surface.vertices().begin(), surface.vertices().end());
    if (scene.laryngoscope_pose() && scene.keys() && !is_bone(surface.model().tissue)) {
        const PlacedGiveWay give_way =
            give_way_to(scene.keys()->laryngoscope(), *scene.laryngoscope_pose(), scene.landmarks());
        for (LitVertex& vertex : vertices) {
            vertex.position = give_way(vertex.position);
        }
    }
    return vertices;
}

}  // namespace eti::view
