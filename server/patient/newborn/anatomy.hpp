// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// Implicit fields of a patient at one point, negative inside, in metres.
struct Fields {
    float skin = 1.0f;  ///< outline of head, neck and shoulders
    float cavity =
        1.0f;  ///< mouth, pharynx, larynx, trachea, oesophagus; as if tongue and epiglottis were away
    float tongue = 1.0f;
    /// Gap beneath the tongue's tip with the frenulum left standing, within `tongue`: too flat for particles,
    /// which fill it, and cut out of what is seen.
    float sublingual = 1.0f;
    float epiglottis = 1.0f;
    float upper_gum = 1.0f, lower_gum = 1.0f;
    float palate = 1.0f;   ///< hard and soft palate with uvula
    float larynx = 1.0f;   ///< arytenoids, cords, cricoid region (tissue around the laryngeal lumen)
    float cricoid = 1.0f;  ///< the cartilage ring within it
    float skull = 1.0f, mandible = 1.0f, spine = 1.0f, hyoid = 1.0f;
};

/// What a model is built from: where each organ is, and how the skeleton carries it. Points are in the
/// patient frame: DICOM LPS, metres, origin at the upper gum's crest.
class Anatomy {
  public:
    virtual ~Anatomy() = default;

    [[nodiscard]] virtual Fields fields(const Vec3f& point) const = 0;
    [[nodiscard]] virtual Skeleton skeleton() const = 0;

    /// How much trunk, skull and mandible carry a point of the given tissue.
    [[nodiscard]] virtual BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const = 0;

    /// How a point of skin or skull moves [m] per unit of the cranium's growth over its own size.
    [[nodiscard]] virtual Vec3f head_growth(const Vec3f& point) const = 0;

    /// How far [m] inside the tissue the offset shell lies at a point: what gives way under a tool before
    /// the rigid shell holds it. Mucosa over bone hardly gives; cords and gullet widen for a tube.
    [[nodiscard]] virtual float shell_offset(const Vec3f& point, const Fields& fields) const = 0;

    [[nodiscard]] virtual std::array<Vec3f, landmark_count> landmarks() const = 0;

    /// Corners of the box that holds the head and neck [m].
    [[nodiscard]] virtual std::array<Vec3f, 2> bounds() const = 0;
    /// Corners of the box that holds mouth, pharynx, larynx and trachea [m].
    [[nodiscard]] virtual std::array<Vec3f, 2> airway_bounds() const = 0;

    /// Model coordinates (x left, y anterior, z superior, millimetres of a 3.5 kg term newborn).
    [[nodiscard]] virtual Vec3f to_model(const Vec3f& point) const = 0;
    [[nodiscard]] virtual float scale() const = 0;   ///< metres per model millimetre
    [[nodiscard]] virtual float weight() const = 0;  ///< [kg]

    /// The rim of the glottic opening, a closed polygon [m].
    [[nodiscard]] std::vector<Vec3f> glottis_contour() const;
};

}  // namespace eti::anatomy
