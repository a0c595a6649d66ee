// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "server/patient/newborn/skinner.hpp"

namespace eti::anatomy {

/// Where bones move neighbours apart, as at the corner of the mouth and between the gums, a surface would
/// tear in some posture, however smoothly particles carry it. Around such edges bones alone carry it, and
/// their weights are levelled along the surface until no edge is stretched more than bearable in any posture.
void mend_skin(const Patient& patient, const TriangleMesh& mesh, std::span<Shares> carried);

}  // namespace eti::anatomy
