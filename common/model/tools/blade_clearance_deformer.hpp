// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools/tools.hpp"

namespace eti {

/// The plate of a straight blade in the tool frame, as drawn and as used for clearance: its width, and the
/// height of its contact face above the axis.
struct BladePlate {
    float length = 0.0f;               ///< [m], handle to tip
    float wide = 0.0f, narrow = 0.0f;  ///< [m], at the heel and before the tip
    float high = 0.0f, low = 0.0f;     ///< [m], height of the crown at heel and tip
    float crown = 0.0f;                ///< [m], height of the crown above the edges at the heel

    /// Rounding of the edge before the tip [m], and width at the tip relative to that before the rounding.
    static constexpr float rounding = 4e-3f, tip_width = 0.45f;

    [[nodiscard]] float width(float along) const;
    [[nodiscard]] float height(float along) const;
    /// Half width [m], rounded about the tip.
    [[nodiscard]] float outline(float along) const;
};

[[nodiscard]] BladePlate plate_of(const Laryngoscope& scope);

/// Deforms the drawn tissue so that it clears the blade. The particles that contact keeps off the blade are
/// as far apart as they are large, so the surface skinned to them crosses the plate in places by one or two
/// millimetres. Lips follow bones and have no contact at all (docs/decisions/blade-clearance.md). The steps,
/// in order:
/// - Where the blade passes the corner of the mouth, the corner moves sideways as a whole.
/// - Tissue across the tip, too deep to come out over the face, moves past the tip if the tip penetrates it
///   by up to `tip`: the capsule that keeps particles off is rounder there.
/// - Tissue that crosses an edge of plate or flange by up to `edge` moves sideways to `clearance` beyond it.
/// - Tissue on the other side of the contact face, or within it by at most `deepest`, moves along the blade's
///   +y to `clearance` in front of the face, with a smooth transition over `softness`. Deeper points lie
///   behind the plate; they stay, or move as far as the lens.
/// client/render/passes/blade_clearance_shader.hpp computes the same on the GPU.
struct BladeClearanceDeformer {
    static constexpr float clearance = 0.2e-3f;  ///< [m]
    static constexpr float softness = 0.8e-3f;   ///< [m], half the height of the transition
    static constexpr float deepest = 2.5e-3f;    ///< [m], depth up to which tissue comes out fully
    static constexpr float steepest = 2.0f;      ///< slope beyond that depth, up to tissue that stays
    static constexpr float easing = 0.6e-3f;     ///< [m], over which that slope begins and ends
    static constexpr float beside = 4.0e-3f;     ///< [m], falloff from the plate's edge and tip
    static constexpr float heel = 12.0e-3f;      ///< [m] along the blade, where the plate begins
    static constexpr float under = 5.0e-3f;      ///< [m], beneath the crown: plate and flange
    /// [m]: the largest crossing, where the motion begins, and how far points there move. They move less
    /// where the plate is narrower than that, so that its middle does not move.
    static constexpr float edge = 1.6e-3f, edge_begins = 3.4e-3f, edge_aside = edge + clearance;
    /// [m]: the largest penetration, how far points there move, and where the motion begins.
    static constexpr float tip = 2.4e-3f, tip_past = tip + clearance, tip_begins = tip + 1.2f * tip_past;
    /// [m] behind the face: where the motion begins (tissue in mere contact with the face does not move),
    /// where it is complete, and where it ends.
    static constexpr float tip_from = 0.5e-3f, tip_until = 3.6e-3f, tip_ends = 7.6e-3f;
    static constexpr float tip_beside = 6.0e-3f;  ///< [m], falloff from the plate's edge
    static constexpr float before_tip = 1.0e-3f;  ///< [m]; here the edge continues straight to the tip
    static constexpr float spare = 1.0e-3f;       ///< [m], between plate and the mouth's corner
    /// [m], about the plate and behind the gum: falloff of the corner's sideways motion.
    static constexpr float lips_fade = 10e-3f;
    /// [m] from the lens: clearance below it, radius of full effect, and radius where the effect ends.
    static constexpr float lens_spare = 0.5e-3f, lens_wholly = 2e-3f, lens_fade = 8e-3f;
    /// Compression limit: displaced tissue is compressed by less than half, over this multiple of the
    /// displacement.
    static constexpr float gathers = 4.0f;

    BladePlate plate;
    Vec3f lens = Vec3f(0.0f, 0.0f, 1.0f);  ///< [m]
    float side = 1.0f;                     ///< side of the mouth's nearer corner: 1 is +x, -1 is -x
    float corner = 0.0f;                   ///< [m], position of that corner towards its side
    float aside = 0.0f;                    ///< [m], sideways displacement of the corner; 0: none
    float lips_end = 0.0f;                 ///< [m] along the blade, where the gum begins

    /// [m]: maximum displacement out of or down from the face, and of the mouth's corner sideways.
    static constexpr float most = 2.8e-3f, max_corner_shift = 6.0e-3f;
    /// No edge of a surface is stretched by more than this factor.
    static constexpr float max_stretch = 3.0f;

    /// Largest displacement of any point [m].
    [[nodiscard]] float reach() const { return most + aside + edge_aside + tip_past; }
    /// The same of points within `radius` [m] of `centre`; tool frame. 0 if none moves.
    [[nodiscard]] float reach(const Vec3f& centre, float radius) const;
    /// Points outside this box [m] do not move; tool frame.
    [[nodiscard]] Eigen::AlignedBox3f where() const;
    /// Whether any point within `radius` [m] of `centre` may move; tool frame.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;

    /// The displaced point [m]; tool frame.
    [[nodiscard]] Vec3f operator()(const Vec3f& point) const;

  private:
    [[nodiscard]] float depth_behind_face(const Vec3f& p) const;
    [[nodiscard]] float shift_past_tip(const Vec3f& p) const;
    [[nodiscard]] Vec3f push_off_face(Vec3f p) const;
};

/// The deformer of a blade at a pose.
struct PosedBladeClearanceDeformer {
    BladeClearanceDeformer give_way;
    RigidTransform tool;

    [[nodiscard]] Vec3f operator()(const Vec3f& point) const {
        return tool * give_way(tool.inverse() * point);
    }
    /// Largest displacement [m] of points within `radius` of `centre`; 0 if none moves.
    [[nodiscard]] float reach(const Vec3f& centre, float radius) const {
        return give_way.reach(tool.inverse() * centre, radius);
    }
};

/// The deformer of a laryngoscope at a pose, for a mouth with these landmarks.
[[nodiscard]] PosedBladeClearanceDeformer blade_clearance_for(const Laryngoscope& scope,
                                                              const RigidTransform& tool,
                                                              const Landmarks& now);

}  // namespace eti
