// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "server/patient/newborn/skinner.hpp"

namespace eti::anatomy {

/// Where a blade lifts tongue and epiglottis away from what bones hold, neighbours part that shares from
/// place to place let part: beside the plate, in the valleculae and under it. There the shares of all frames
/// are levelled along the surface, as far around as it takes, until no edge is stretched more than bearable:
/// as bones move, and in a lift as a blade makes it. `carried` sum to one, and still do.
void level_skin(const Anatomy& anatomy, const Patient& patient, const TriangleMesh& mesh,
                std::span<Shares> carried);

}  // namespace eti::anatomy
