// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

struct SegmentSettings {
    float air_below = -480.0f;  ///< [HU], half-way between air and soft tissue
    float bone_above = 226.0f;  ///< [HU], the usual bone threshold in CT
    /// [m], radius of the ball that closes lips and nostrils. A larger one closes wider openings and fills
    /// folds of the neck.
    float closing = 6.0e-3f;
    float smallest_bone = 20e-9f;       ///< [m^3]; smaller pieces are noise or calcifications
    float tongue_smoothing = 1.3e-3f;   ///< [m], standard deviation: averages noise against 20 HU of contrast
    float tongue_curvature = 0.35e-3f;  ///< [m], see imaging::LevelSetSettings
};

/// Result for one structure.
struct Structure {
    std::string name;
    bool found = false;
    double volume = 0.0;  ///< [m^3]
    std::string note;     ///< why it was not found, or a remark
};

struct Segmentation {
    imaging::Mask labels;               ///< values of Label, on the input's grid
    Points points;                      ///< seeds used, given or placed
    std::vector<Structure> structures;  ///< skin, bone, airway, larynx, mandible, spine, tongue
    double turn = 0.0;                  ///< [rad], rotation of the head from the file's directions
    /// Contradictions for the user: between file and image, organs of implausible size or position (which get
    /// no label), seeds outside of their organ.
    std::vector<std::string> contradictions;
    float noise = 0.0f;  ///< [HU], standard deviation, see estimate_noise()
    /// Of the tongue: its grey value's distance from the threshold to its neighbours, in standard deviations
    /// of the noise after smoothing. Infinite without noise, 0 without a tongue.
    float tongue_contrast_to_noise = 0.0f;
    /// Why labels deserve little confidence, though nothing contradicts them.
    std::vector<std::string> uncertainties;
};

/// Segments a CT of head and neck.
/// - Air, bone and soft tissue by threshold. The patient is the largest body, closed by a ball; the airway is
///   the largest space inside it that opens at nose or mouth (Xiao et al. 2020, section 4.1, manually in
///   ITK-SNAP).
/// - Mandible, spine and tongue by narrow-band level sets from seeds: `given` ones, else placed by anatomy in
///   the head's own frame (head_frame.hpp), for any orientation of patient and axes.
/// Labels and points are in the volume's frame. Structures that the volume does not show are reported as not
/// found and not labelled. Throws VolumeError if the volume is not a CT of a head, CancelledError if
/// `progress` cancels.
[[nodiscard]] Segmentation segment(const imaging::Volume& volume, const Points& given,
                                   const SegmentSettings& settings, const Progress& progress);

}  // namespace eti::segmentation
