// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/tissue.hpp"
#include "server/anatomy/patient.hpp"

namespace eti::anatomy {

/// Implicit fields of the newborn at one point, negative inside, in metres.
struct NewbornFields {
    float skin = 1.0f;  ///< outline of head, neck and shoulders
    float cavity =
        1.0f;  ///< mouth, pharynx, larynx, trachea, oesophagus; as if tongue and epiglottis were away
    float tongue = 1.0f;
    float epiglottis = 1.0f;
    float upper_gum = 1.0f, lower_gum = 1.0f;
    float palate = 1.0f;  ///< hard and soft palate with uvula
    float larynx = 1.0f;  ///< arytenoids, cords, cricoid region (tissue around the laryngeal lumen)
    float skull = 1.0f, mandible = 1.0f, spine = 1.0f, hyoid = 1.0f;
};

/// The parametric newborn: ellipsoids, capsules and elliptical ducts along mid-sagittal stations,
/// merged by smooth minima, at rest (lips parted, neck neutral). Proportions follow docs/anatomy.md.
/// Points are in the patient frame: DICOM LPS, metres, origin at the upper gum's crest.
class Newborn {
  public:
    explicit Newborn(const NewbornShape& shape);

    [[nodiscard]] NewbornFields fields(const Vec3f& point) const;
    [[nodiscard]] Skeleton skeleton() const;

    /// How much trunk, skull and mandible carry a point of the given tissue.
    [[nodiscard]] BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const;

    /// How far [m] inside the tissue the offset shell lies at a point: what gives way under a tool before
    /// the rigid shell holds it. Mucosa over bone hardly gives; cords and gullet widen for a tube.
    [[nodiscard]] float shell_offset(const Vec3f& point, const NewbornFields& fields) const;

    [[nodiscard]] std::array<Vec3f, landmark_count> landmarks() const;
    [[nodiscard]] std::vector<Vec3f> glottis_contour() const;

    /// Corners of the box that holds the head and neck [m].
    [[nodiscard]] std::array<Vec3f, 2> bounds() const;
    /// Corners of the box that holds mouth, pharynx, larynx and trachea [m].
    [[nodiscard]] std::array<Vec3f, 2> airway_bounds() const;

    /// Model coordinates (x left, y anterior, z superior, millimetres of a 3.5 kg term newborn).
    [[nodiscard]] Vec3f to_model(const Vec3f& point) const;
    [[nodiscard]] Vec3f from_model(const Vec3f& point) const;
    [[nodiscard]] float scale() const { return scale_; }  ///< metres per model millimetre

  private:
    /// From this newborn's model coordinates to those of the usual newborn and back, where the larynx lies
    /// elsewhere.
    [[nodiscard]] Vec3f usual_place(const Vec3f& model) const;
    [[nodiscard]] Vec3f own_place(const Vec3f& model) const;
    /// The closed jaw's coordinates, and back.
    [[nodiscard]] Vec3f to_jaw(const Vec3f& model) const;
    [[nodiscard]] Vec3f from_jaw(const Vec3f& closed) const;
    [[nodiscard]] float tongue_field(const Vec3f& model) const;

    NewbornShape shape_;
    float scale_;
    float rest_jaw_deg_;  // turn of the modelled jaw from closed
    float cranium_;       // size against the face, 1 at term
    Vec3f larynx_shift_;  // [mm of a 3.5 kg newborn], x left, y anterior, z superior
};

}  // namespace eti::anatomy
