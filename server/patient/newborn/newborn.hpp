// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "common/model/newborn_shape.hpp"
#include "server/patient/newborn/anatomy.hpp"
#include "server/patient/newborn/body/body_shape.hpp"

namespace eti::patient {

/// The parametric newborn: ellipsoids, capsules and elliptical ducts along mid-sagittal stations, joined by
/// smooth minima, at rest (lips parted, neck neutral). Proportions follow docs/anatomy/README.md.
class Newborn final : public Anatomy {
  public:
    explicit Newborn(const NewbornShape& shape);

    [[nodiscard]] Fields fields(const Vec3f& point) const override;
    [[nodiscard]] VisibleFields visible_fields(const Vec3f& point) const override;
    [[nodiscard]] float visible_detail(const Vec3f& point) const override;
    [[nodiscard]] Tissue visible_tissue(const Vec3f& point) const override;
    [[nodiscard]] float epiglottis_coupling(const Vec3f& point) const override;
    [[nodiscard]] Skeleton skeleton() const override;
    [[nodiscard]] BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const override;
    [[nodiscard]] Vec3f head_growth(const Vec3f& point) const override;
    [[nodiscard]] float shell_field(const Vec3f& point, const Fields& fields) const override;
    [[nodiscard]] std::array<Vec3f, landmark_count> landmarks() const override;
    [[nodiscard]] std::array<Vec3f, 2> bounds() const override;
    [[nodiscard]] std::array<Vec3f, 2> visible_bounds() const override;
    [[nodiscard]] std::array<Vec3f, 2> airway_bounds() const override;
    [[nodiscard]] Vec3f to_model(const Vec3f& point) const override;
    [[nodiscard]] Vec3f from_model(const Vec3f& point) const;
    [[nodiscard]] float scale() const override { return scale_; }
    [[nodiscard]] float weight() const override { return shape_.weight; }

  private:
    /// Map between this newborn's model coordinates and those of the standard newborn, whose larynx lies
    /// elsewhere.
    [[nodiscard]] Vec3f usual_place(const Vec3f& model) const;
    [[nodiscard]] Vec3f own_place(const Vec3f& model) const;
    /// Map to the closed jaw's coordinates, and back.
    [[nodiscard]] Vec3f to_jaw(const Vec3f& model) const;
    [[nodiscard]] Vec3f from_jaw(const Vec3f& closed) const;
    /// Maps to coordinates in which the tongue is that of a standard closed jaw.
    [[nodiscard]] Vec3f to_tongue(const Vec3f& model) const;
    [[nodiscard]] float tongue_field(const Vec3f& model) const;
    [[nodiscard]] Vec3f tongue_dorsum() const;

    /// Outline of the drawn skin [mm] at a point of the standard newborn. `in_jaw`: that point, closed jaw.
    [[nodiscard]] float visible_outline(const Vec3f& p, const Vec3f& in_jaw) const;

    NewbornShape shape_;
    float scale_;
    float rest_jaw_deg_;                     // opening of the modelled jaw
    float cranium_;                          // size relative to the face; 1 at term
    Vec3f larynx_shift_;                     // [mm of a 3.5 kg newborn], x left, y anterior, z superior
    std::shared_ptr<const BodyShape> body_;  // none if the program was built without
};

}  // namespace eti::patient
