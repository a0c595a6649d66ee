// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/displaced_vertices.hpp"

#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::view {

std::vector<LitVertex> displaced_vertices(const SceneView& scene, const SkinnedSurface& surface) {
    std::vector<LitVertex> vertices(surface.vertices().begin(), surface.vertices().end());
    if (scene.laryngoscope_pose() && scene.keys() && !is_bone(surface.model().tissue)) {
        const PosedBladeClearanceDeformer give_way =
            blade_clearance_for(scene.keys()->laryngoscope(), *scene.laryngoscope_pose(), scene.landmarks());
        for (LitVertex& vertex : vertices) {
            vertex.position = give_way(vertex.position);
        }
    }
    return vertices;
}

}  // namespace eti::view
