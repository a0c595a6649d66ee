// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "server/patient/newborn/build/skinner.hpp"

namespace eti::patient {

/// Where a blade lifts tongue and epiglottis off tissue bound to bone, neighbours separate whose weights
/// differ: beside the plate, in the valleculae and under it. There the weights of all frames are smoothed
/// along the surface, as widely as needed, until no edge exceeds the stretch limit under motion of bones and
/// under a blade's lift. `carried`: weights, which sum to one before and after.
/// `tissues`: of the vertices.
void smooth_skin_weights(const Anatomy& anatomy, const Patient& patient, const TriangleMesh& mesh,
                         std::span<const Tissue> tissues, std::span<Shares> carried);

}  // namespace eti::patient
