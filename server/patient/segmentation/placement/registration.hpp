// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "common/math/transform.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

/// The labels do not include a larynx; surfaces can still be made from them.
class NoLarynxError : public imaging::VolumeError {
    using imaging::VolumeError::VolumeError;
};

/// Pose of the parametric newborn in a labelled volume.
struct Registration {
    float weight = 3.5f;   ///< [kg], of a newborn of this size
    RigidTransform place;  ///< patient frame to the volume's LPS frame
    double off = 0.0;      ///< [m], mean distance between its surfaces and the labels'
};

/// Registers the parametric newborn to labels: airway, mandible, tongue and spine are translated, rotated and
/// scaled to the labels' surfaces (point-to-surface distances, Gauss-Newton with Huber weights, started from
/// several tilts of the head). `labels` must be on an isotropic grid along LPS. Throws VolumeError if airway
/// or mandible has no label.
[[nodiscard]] Registration register_newborn(const imaging::Mask& labels);

}  // namespace eti::segmentation
