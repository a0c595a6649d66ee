// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/patient/imaging/volume.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/segmentation/labels.hpp"
#include "server/patient/segmentation/placement/registration.hpp"

namespace eti::segmentation {

/// A patient from labels. Skin, airway, tongue, skull, mandible and spine are signed distances of the labels.
/// What a CT does not show (gums, palatal mucosa, the border of larynx and epiglottis, the collapsed gullet,
/// joints and bone weights) comes from the parametric newborn registered to the labels. The patient frame is
/// the newborn's.
class LabelledAnatomy final : public patient::Anatomy {
  public:
    /// `given` sets landmarks (common/model/landmark.hpp) manually, in the volume's frame. Throws
    /// NoLarynxError if the labels end above the larynx, VolumeError if they are not a newborn's head and
    /// neck, CancelledError.
    LabelledAnatomy(const imaging::Mask& labels, const Points& given, const Progress& progress);

    [[nodiscard]] patient::Fields fields(const Vec3f& point) const override;
    [[nodiscard]] patient::Skeleton skeleton() const override { return newborn_.skeleton(); }
    [[nodiscard]] patient::BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const override {
        return newborn_.bone_weights(point, tissue);
    }
    [[nodiscard]] Vec3f head_growth(const Vec3f& point) const override { return newborn_.head_growth(point); }
    [[nodiscard]] float shell_field(const Vec3f& point, const patient::Fields& fields) const override {
        return newborn_.shell_field(point, fields);
    }
    [[nodiscard]] std::array<Vec3f, landmark_count> landmarks() const override { return landmarks_; }
    [[nodiscard]] std::array<Vec3f, 2> bounds() const override { return newborn_.bounds(); }
    [[nodiscard]] std::array<Vec3f, 2> airway_bounds() const override { return newborn_.airway_bounds(); }
    [[nodiscard]] Vec3f to_model(const Vec3f& point) const override { return newborn_.to_model(point); }
    [[nodiscard]] float scale() const override { return newborn_.scale(); }
    [[nodiscard]] float weight() const override { return newborn_.weight(); }

    /// Pose of the patient frame in the volume.
    [[nodiscard]] const Registration& registration() const { return registration_; }
    /// Remarks for the user on what was taken from the newborn although labels could show it.
    [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  private:
    void require_larynx(const imaging::Mask& labels) const;
    void place_landmarks(const Points& given);

    Registration registration_;
    patient::Newborn newborn_;
    DistanceGrid skin_, airway_, skull_, mandible_;
    std::optional<DistanceGrid> tongue_, spine_, epiglottis_;
    std::array<Vec3f, landmark_count> landmarks_{};
    std::vector<std::string> remarks_;
};

}  // namespace eti::segmentation
