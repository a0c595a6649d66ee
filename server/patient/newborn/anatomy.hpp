// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
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

/// Outlines of what one looks at, at one point, negative inside, in metres: the organs of Fields, in a detail
/// that no particle needs to know.
struct Seen {
    float body = 1.0f;  ///< skin without mouth and airway; lining, gums, palate and larynx belong to it
    float tongue = 1.0f;
    float epiglottis = 1.0f;
    float cloth = 1.0f;  ///< about the trunk, if there is any
};

/// The body as particles and shell know it, without tongue and epiglottis; the tongue sinks by `overlap` into
/// the mouth's floor.
[[nodiscard]] inline float body_field(const Fields& f, float tongue, float overlap) {
    return std::max(f.skin, -std::min(f.cavity, tongue + overlap));
}

/// What a model is built from: where each organ is, and how the skeleton carries it. Points are in the
/// patient frame: DICOM LPS, metres, origin at the upper gum's crest.
class Anatomy {
  public:
    virtual ~Anatomy() = default;

    [[nodiscard]] virtual Fields fields(const Vec3f& point) const = 0;
    /// What is drawn and what hides the glottis from an eye. Physics takes nothing from it. By default the
    /// outlines of fields().
    [[nodiscard]] virtual Seen seen(const Vec3f& point) const;
    [[nodiscard]] virtual Skeleton skeleton() const = 0;

    /// The tissue that lines the body's inside at a point: what a tool meets there.
    [[nodiscard]] Tissue lining(const Vec3f& point) const;
    /// The tissue that shows at a point of the body's surface.
    [[nodiscard]] virtual Tissue seen_tissue(const Vec3f& point) const;

    /// How much of what the epiglottis does a point of the body's or the tongue's surface does, too: 1 on
    /// folds that hang on it, where they leave the plate, 0 away from them.
    [[nodiscard]] virtual float hangs_on_epiglottis(const Vec3f& /*point*/) const { return 0.0f; }

    /// How much trunk, skull and mandible carry a point of the given tissue.
    [[nodiscard]] virtual BoneWeights bone_weights(const Vec3f& point, Tissue tissue) const = 0;

    /// How a point of skin or skull moves [m] per unit of the cranium's growth over its own size.
    [[nodiscard]] virtual Vec3f head_growth(const Vec3f& point) const = 0;

    /// The offset shell as a field [m], negative in what holds a tool. It lies within body_field() by what
    /// gives way before: mucosa over bone hardly does; cords and gullet widen for a tube.
    [[nodiscard]] virtual float shell_field(const Vec3f& point, const Fields& fields) const = 0;

    [[nodiscard]] virtual std::array<Vec3f, landmark_count> landmarks() const = 0;

    /// Corners of the box that holds the head and neck [m].
    [[nodiscard]] virtual std::array<Vec3f, 2> bounds() const = 0;
    /// Corners of the box that is drawn [m].
    [[nodiscard]] virtual std::array<Vec3f, 2> seen_bounds() const { return bounds(); }
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
