// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <span>

#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// Model of the soft tissue's force on the hand.
enum class SoftForce : std::uint8_t {
    constraint,    ///< the contact forces of the simulation's constraints [N], extrapolated between messages
    displacement,  ///< Xiao et al. 2020, sec. 4.3: mean displacement times a stiffness per tissue type
};

/// Stiffness [N/m] per tissue type in the mode `displacement`: E A / L of a layer pressed by the blade, with
/// A = 10 mm x 30 mm of blade, L = 15 mm of tissue under it. E is 8 kPa for tongue and soft palate (Cheng et
/// al. 2011, J Biomech 44:450). The larynx has that of the vocal folds, 8.6 kPa (J Voice 2011;25); the other
/// soft types have the tongue's. Gums, palate and bones are rigid: the shell stops the proxy there, and their
/// particles have no effect here.
[[nodiscard]] const std::array<float, tissue_count>& tissue_stiffness();

/// Whether a particle touches a capsule of the blade at `pose`.
[[nodiscard]] bool touches(const TissuePoint& point, std::span<const Capsule> blade,
                           const RigidTransform& pose);

/// The paper's law: per tissue type, the average displacement (rest minus current) of the particles in
/// contact times the type's stiffness, averaged over the types in contact. Each type's force acts at the mean
/// position of its particles, which gives the torque about the origin of `pose`. A type without stiffness is
/// excluded from the average.
[[nodiscard]] Wrench displacement_wrench(std::span<const TissuePoint> points, std::span<const Capsule> blade,
                                         const RigidTransform& pose,
                                         const std::array<float, tissue_count>& stiffness);

/// The reported wrench, extrapolated from the reported pose of the blade to `pose`. Each particle's force
/// changes with the blade's penetration by the particle's own secant stiffness, its force over its
/// displacement from rest. This is a local model of the tissue in the sense of Mazzella, Montgomery & Latombe
/// (ICRA 2002), as the planes of proxy_prediction.hpp are one of the shell. A particle never pulls, and never
/// pushes more than twice as hard as reported.
[[nodiscard]] Wrench constraint_wrench(const TissueReport& report, const RigidTransform& pose);

/// Smooths either model: the change by a new message is spread over the time until the next one.
class SmoothSoftForce {
  public:
    /// `wanted` by the newest message, which arrived at `arrived` [ns]; `over` [s]: until the next is due.
    Wrench update(const Wrench& wanted, std::int64_t arrived, float over, float dt);

  private:
    std::int64_t arrived_ = 0;
    Wrench last_, lacking_;  // last output; change by the last message, to be added gradually
    float left_ = 0.0f;      // share of `lacking_` still to be added
};

}  // namespace eti::devices
