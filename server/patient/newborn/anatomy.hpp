// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// Implicit fields of a patient at one point [m], negative inside.
struct Fields {
    float skin = 1.0f;  ///< outline of head, neck and shoulders
    float cavity =
        1.0f;  ///< mouth, pharynx, larynx, trachea, oesophagus; as if without tongue and epiglottis
    float tongue = 1.0f;
    /// Gap beneath the tongue's tip beside the frenulum, within `tongue`. It is too flat for particles, which
    /// fill it; the drawn surface excludes it.
    float sublingual = 1.0f;
    float epiglottis = 1.0f;
    float upper_gum = 1.0f, lower_gum = 1.0f;
    float palate = 1.0f;   ///< hard and soft palate with uvula
    float larynx = 1.0f;   ///< arytenoids, vocal cords, cricoid region (tissue around the laryngeal lumen)
    float cricoid = 1.0f;  ///< the cartilage ring within it
    float skull = 1.0f, mandible = 1.0f, spine = 1.0f, hyoid = 1.0f;
};

/// Drawn outlines at one point [m], negative inside: the organs of Fields in more detail than particles
/// resolve.
struct VisibleFields {
    float body = 1.0f;  ///< skin without mouth and airway; includes lining, gums, palate and larynx
    float tongue = 1.0f;
    float epiglottis = 1.0f;
    float cloth = 1.0f;  ///< around the trunk, if any
};

/// The body as particles and shell represent it, without tongue and epiglottis; the tongue overlaps the floor
/// of the mouth by `overlap`.
[[nodiscard]] inline float body_field(const Fields& f, float tongue, float overlap) {
    return std::max(f.skin, -std::min(f.cavity, tongue + overlap));
}

/// Source of a model: where each organ is, and how the skeleton moves it. Points are in the patient frame:
/// DICOM LPS, metres, origin at the upper gum's crest.
class Anatomy {
  public:
    virtual ~Anatomy() = default;

    [[nodiscard]] virtual Fields fields(const Vec3f& point) const = 0;
    /// Outlines for drawing and for occlusion of the glottis; not used by physics. By default those of
    /// fields().
    [[nodiscard]] virtual VisibleFields visible_fields(const Vec3f& point) const;
    /// Longest edge [m] with which drawn skin should be resolved at a point.
    [[nodiscard]] virtual float visible_detail(const Vec3f& /*point*/) const {
        return std::numeric_limits<float>::max();
    }
    [[nodiscard]] virtual Skeleton skeleton() const = 0;

    /// Tissue of the body's inner lining at a point, for contact with tools.
    [[nodiscard]] Tissue lining(const Vec3f& point) const;
    /// Tissue that is visible at a point of the body's surface.
    [[nodiscard]] virtual Tissue visible_tissue(const Vec3f& point) const;

    /// Fraction of the epiglottis's motion that a point of the body's or the tongue's surface follows: 1 on
    /// folds where they join the plate, 0 far from them.
    [[nodiscard]] virtual float epiglottis_coupling(const Vec3f& /*point*/) const { return 0.0f; }

    /// Weights of trunk, skull and mandible for a point of the given tissue.
    [[nodiscard]] virtual BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const = 0;

    /// Displacement of a point of skin or skull [m] per unit of the cranium's growth over its own size.
    [[nodiscard]] virtual Vec3f head_growth(const Vec3f& point) const = 0;

    /// The offset shell as a field [m], negative inside. It lies within body_field() by the depth that yields
    /// before a tool is stopped: small for mucosa over bone, large for vocal cords and gullet, which widen
    /// for a tube.
    [[nodiscard]] virtual float shell_field(const Vec3f& point, const Fields& fields) const = 0;

    [[nodiscard]] virtual std::array<Vec3f, landmark_count> landmarks() const = 0;

    /// Corners [m] of the bounding box of head and neck.
    [[nodiscard]] virtual std::array<Vec3f, 2> bounds() const = 0;
    /// Corners [m] of the bounding box of drawn surfaces.
    [[nodiscard]] virtual std::array<Vec3f, 2> visible_bounds() const { return bounds(); }
    /// Corners [m] of the bounding box of mouth, pharynx, larynx and trachea.
    [[nodiscard]] virtual std::array<Vec3f, 2> airway_bounds() const = 0;

    /// Point in model coordinates (x left, y anterior, z superior, millimetres of a 3.5 kg term newborn).
    [[nodiscard]] virtual Vec3f to_model(const Vec3f& point) const = 0;
    [[nodiscard]] virtual float scale() const = 0;   ///< metres per model millimetre
    [[nodiscard]] virtual float weight() const = 0;  ///< [kg]

    /// The rim of the glottic opening, a closed polygon [m].
    [[nodiscard]] std::vector<Vec3f> glottis_contour() const;
};

}  // namespace eti::patient
