// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "common/math/transform.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

/// The labels show no larynx; what they do show can still be turned into surfaces.
class NoLarynx : public imaging::VolumeError {
    using imaging::VolumeError::VolumeError;
};

/// Where the parametric newborn lies in a labelled volume.
struct Registration {
    float weight = 3.5f;   ///< [kg], of a newborn of this size
    RigidTransform place;  ///< patient frame to the volume's LPS frame
    double off = 0.0;      ///< [m], mean distance of its surfaces from the labels' surfaces
};

/// Lays the parametric newborn over labels: its airway, mandible, tongue and spine are moved, turned and
/// scaled until they lie on the labels' surfaces (point-to-surface distances, Gauss-Newton with Huber's
/// weights, started at several tilts of the head). `labels` lie on an upright grid of equal spacing. Throws
/// VolumeError where airway or mandible has no label.
[[nodiscard]] Registration lay_newborn_over(const imaging::Mask& labels);

}  // namespace eti::segmentation
