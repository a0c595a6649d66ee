// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/filter.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

/// What thresholds, closing and components tell of a CT on an upright grid of equal spacing.
struct TissueMap {
    imaging::Bits outside;  ///< air around the patient, couch
    imaging::Bits airway;
    imaging::Bits enclosed_air;  ///< inside the patient, but not part of the airway
    imaging::Bits bone;
    imaging::Bits soft;         ///< the rest of the patient
    bool airway_opens = false;  ///< at nose or mouth
};

/// A CT has air, soft tissue and no wild values: throws VolumeError, beginning with "the volume", of
/// scrambled bytes and images of other kinds.
void require_ct(const imaging::Volume& ct, const SegmentSettings& settings);

[[nodiscard]] TissueMap map_tissues(const imaging::Volume& ct, const SegmentSettings& settings);

}  // namespace eti::segmentation
