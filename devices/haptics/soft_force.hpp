// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <span>

#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// How the soft tissue's force on the hand is found.
enum class SoftForce : std::uint8_t {
    constraint,    ///< the contact forces of the simulation's constraints [N], carried on between messages
    displacement,  ///< Xiao et al. 2020, sec. 4.3: mean displacement times a stiffness per tissue type
};

/// Stiffness [N/m] per tissue type in the mode `displacement`: E A / L of a layer pressed by the blade,
/// with A = 10 mm x 30 mm of blade, L = 15 mm of tissue under it. E of tongue and soft palate 8 kPa
/// (Cheng et al. 2011, J Biomech 44:450), of the vocal folds 8.6 kPa (J Voice 2011;25), which stand for
/// the larynx; the other soft types take the tongue's. Gums, palate and bones are rigid: the shell
/// stops the proxy there, and their particles count for nothing here.
[[nodiscard]] const std::array<float, tissue_count>& tissue_stiffness();

/// Whether a particle touches a capsule of the blade at `pose`.
[[nodiscard]] bool touches(const TissuePoint& point, std::span<const Capsule> blade,
                           const RigidTransform& pose);

/// The paper's law: per tissue type, the average displacement (rest minus current) of the particles in
/// contact times the type's stiffness; averaged over the types in contact. Each type pulls at the mean
/// place of its particles, which gives the torque about the origin of `pose`. A type of no stiffness
/// is left out of the average.
[[nodiscard]] Wrench displacement_wrench(std::span<const TissuePoint> points, std::span<const Capsule> blade,
                                         const RigidTransform& pose,
                                         const std::array<float, tissue_count>& stiffness);

/// The reported wrench, carried on from the reported pose of the blade to `pose`: each particle's force grows
/// and falls with how far the blade goes into it, by the particle's own secant stiffness, its force over its
/// displacement from rest. A local model of the tissue in the sense of Mazzella, Montgomery & Latombe (ICRA
/// 2002), as the planes of proxy_prediction.hpp are one of the shell. No particle pulls, and none pushes
/// more than twice as hard as reported.
[[nodiscard]] Wrench constraint_wrench(const TissueReport& report, const RigidTransform& pose);

/// Of the two laws, made smooth: what a new message changes comes in over the time that the next takes.
class SmoothSoftForce {
  public:
    /// `wanted` by the newest message, which came at `arrived` [ns]; `over` [s]: until the next is due.
    Wrench update(const Wrench& wanted, std::int64_t arrived, float over, float dt);

  private:
    std::int64_t arrived_ = 0;
    Wrench last_, lacking_;  // what was given last; what the last message changed, as it comes in
    float left_ = 0.0f;      // share of `lacking_` that is still to come
};

}  // namespace eti::devices
