// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "server/patient/newborn/build/skinner.hpp"

namespace eti::patient {

/// Where bones move neighbours apart, as at the corner of the mouth and between the gums, a surface would
/// tear in some postures, however smoothly particles carry it. Around such edges the weights are those of
/// bones only, and are smoothed along the surface until no edge exceeds the stretch limit in any posture.
void repair_skin_weights(const Patient& patient, const TriangleMesh& mesh, std::span<Shares> carried);

}  // namespace eti::patient
