// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools.hpp"

namespace eti {

/// The plate of a straight blade in the tool's frame, as drawn and as tissue gives way to it: how wide it is
/// and how high its contact face lies above the axis.
struct BladePlate {
    float length = 0.0f;               ///< [m], handle to tip
    float wide = 0.0f, narrow = 0.0f;  ///< [m], at the heel and before the tip
    float high = 0.0f, low = 0.0f;     ///< [m], the crown there
    float crown = 0.0f;                ///< [m], by how much the edges at the heel lie lower than the crown

    /// [m] before the tip its edge is rounded; its width at the tip, a share of that before.
    static constexpr float rounding = 4e-3f, tip_width = 0.45f;

    [[nodiscard]] float width(float along) const;
    [[nodiscard]] float height(float along) const;
    /// [m] from its middle line to its edge, which is rounded about the tip.
    [[nodiscard]] float outline(float along) const;
};

[[nodiscard]] BladePlate plate_of(const Laryngoscope& scope);

/// How what is drawn of the tissue gives way to the blade. Particles that the blade keeps off are as far
/// apart as they are large, and what is skinned to them crosses the plate here and there by a millimetre or
/// two; lips follow bones and are not kept off at all (docs/decisions/blade-clearance.md). In this order:
/// - Where the blade passes the corner of the mouth, that goes aside as a whole.
/// - What stands across the tip, too deep to come out over the face, goes on past it if the tip is in it
///   by up to `tip`: the capsule that keeps particles off is rounder there.
/// - What comes over an edge of plate or flange by up to `edge` goes aside to `clearance` beyond it.
/// - What lies on the other side of the contact face, or is no deeper in than `deepest`, goes out along the
///   blade's +y until it is `clearance` before the face; it comes to that smoothly over `softness`. Farther
///   in is what lies behind the plate, which stays, or goes as far as to the lens.
/// client/render/give_way_shader.hpp says the same to a graphics card.
struct GiveWay {
    static constexpr float clearance = 0.2e-3f;  ///< [m]
    static constexpr float softness = 0.8e-3f;   ///< [m], half the height over which it sets in
    static constexpr float deepest = 2.5e-3f;    ///< [m], what comes out wholly
    static constexpr float steepest = 2.0f;      ///< beyond that, until it meets what stays
    static constexpr float easing = 0.6e-3f;     ///< [m], over which that begins and ends
    static constexpr float beside = 4.0e-3f;     ///< [m], from the plate's edge and tip, until nothing moves
    static constexpr float heel = 12.0e-3f;      ///< [m] along the blade, where the plate begins
    static constexpr float under = 5.0e-3f;      ///< [m], beneath the crown, plate and flange
    /// [m], and where it begins, and how far what lies there goes: less where the plate is narrower than
    /// that, so that its middle stays.
    static constexpr float edge = 1.6e-3f, edge_begins = 3.4e-3f, edge_aside = edge + clearance;
    /// [m], and where it begins, and how far what lies there goes.
    static constexpr float tip = 2.4e-3f, tip_past = tip + clearance, tip_begins = tip + 1.2f * tip_past;
    /// [m] behind the face: where it begins, so that what only lies on the face stays; until where all goes;
    /// and until nothing does.
    static constexpr float tip_from = 0.5e-3f, tip_until = 3.6e-3f, tip_ends = 7.6e-3f;
    static constexpr float tip_beside = 6.0e-3f;  ///< [m], from the plate's edge, until nothing does
    static constexpr float before_tip = 1.0e-3f;  ///< [m], whose edge goes on to the tip, which is too sharp
    static constexpr float spare = 1.0e-3f;       ///< [m], between plate and the mouth's corner
    /// [m] about the plate and behind the gum, until nothing goes aside with the corner.
    static constexpr float lips_fade = 10e-3f;
    /// [m], from the lens: so much below it, and so far around it wholly, and until nothing moves.
    static constexpr float lens_spare = 0.5e-3f, lens_wholly = 2e-3f, lens_fade = 8e-3f;
    /// What is pressed together lies closer by less than half: over so many times the way.
    static constexpr float gathers = 4.0f;

    BladePlate plate;
    Vec3f lens = Vec3f(0.0f, 0.0f, 1.0f);  ///< [m]
    float side = 1.0f;                     ///< of the mouth's nearer corner: 1 or -1, towards +x or -x
    float corner = 0.0f;                   ///< [m], where that is, towards its side
    float aside = 0.0f;                    ///< [m], by how much it goes aside; nothing does where it is none
    float lips_end = 0.0f;                 ///< [m] along the blade, where the gum begins

    /// [m]; nothing goes farther out or down, nor the mouth's corner farther aside.
    static constexpr float most = 2.8e-3f, most_aside = 6.0e-3f;
    /// No edge of a surface becomes longer than this many times.
    static constexpr float most_stretch = 3.0f;

    /// [m]; no point goes farther.
    [[nodiscard]] float reach() const { return most + aside + edge_aside + tip_past; }
    /// Nothing moves out of this box [m]; tool frame.
    [[nodiscard]] Eigen::AlignedBox3f where() const;
    /// Whether any point within `radius` [m] of `centre` may move; tool frame.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;

    /// Tool frame.
    [[nodiscard]] Vec3f operator()(const Vec3f& point) const;

  private:
    [[nodiscard]] float behind_the_face(const Vec3f& p) const;
    [[nodiscard]] float past_the_tip(const Vec3f& p) const;
    [[nodiscard]] Vec3f off_the_face(Vec3f p) const;
};

/// The same of a blade that is held at a pose.
struct PlacedGiveWay {
    GiveWay give_way;
    RigidTransform tool;

    [[nodiscard]] Vec3f operator()(const Vec3f& point) const {
        return tool * give_way(tool.inverse() * point);
    }
    /// False when nothing in a ball gives way.
    [[nodiscard]] bool may_move(const Vec3f& centre, float radius) const;
};

/// Of a laryngoscope at a pose in a mouth whose landmarks are there.
[[nodiscard]] PlacedGiveWay give_way_to(const Laryngoscope& scope, const RigidTransform& tool,
                                        const Landmarks& now);

}  // namespace eti
