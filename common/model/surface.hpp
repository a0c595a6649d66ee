// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tissue.hpp"

namespace eti {

/// A visible surface of the patient: closed, manifold, oriented outwards; skinned to bones and clusters.
struct Surface {
    std::string name;
    Tissue tissue = Tissue::soft;
    TriangleMesh mesh;                    ///< rest posture
    std::vector<Tissue> triangle_tissue;  ///< one per triangle
    std::vector<SkinWeights> skin;        ///< one per vertex; frames: bones, then clusters
};

}  // namespace eti
