// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/filter.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

/// Result of thresholds, closing and components on a CT with an isotropic grid along LPS.
struct TissueMap {
    imaging::Bits outside;  ///< air around the patient, couch
    imaging::Bits airway;
    imaging::Bits enclosed_air;  ///< inside the patient, not part of the airway
    imaging::Bits bone;
    imaging::Bits soft;         ///< the rest of the patient
    bool airway_opens = false;  ///< at nose or mouth
};

/// Checks that the volume has air and soft tissue and no wild values. Throws VolumeError, starting with "the
/// volume", for scrambled bytes and images of other modalities.
void require_ct(const imaging::Volume& ct, const SegmentSettings& settings);

[[nodiscard]] TissueMap map_tissues(const imaging::Volume& ct, const SegmentSettings& settings);

}  // namespace eti::segmentation
