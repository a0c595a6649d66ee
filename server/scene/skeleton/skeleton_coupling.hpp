// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "server/scene/blade.hpp"
#include "server/scene/posed_shell.hpp"
#include "server/scene/skeleton/yielding_skeleton.hpp"
#include "server/scene/snapshot.hpp"
#include "server/scene/tissue.hpp"

namespace eti::scene {

/// Couples the yielding skeleton to tissue, shell and tools. The bones are unknowns of the implicit mesh's
/// step, as are the forces of the walls on which the mesh presses. What presses on them otherwise enters it
/// with the forces of the last step: the proxy on the shell, and tissue outside the mesh, which passes on
/// what it bears. Not thread safe.
class SkeletonCoupling {
  public:
    SkeletonCoupling(const patient::Patient& patient, const SoftTissue& tissue,
                     const JointProperties& at_term);

    /// Both also place what the bones hold.
    void reset(const patient::Posture& posture, SoftTissue& tissue);
    void follow(const patient::Posture& posture, SoftTissue& tissue);

    [[nodiscard]] const YieldingSkeleton& skeleton() const { return skeleton_; }

    /// From now on the muscles' stress relaxes.
    void relax(const pbd::Relaxation& relaxation) { skeleton_.relax(relaxation); }
    /// Muscle tone, and the force [N] of an assistant's fingers on the larynx, from now on.
    void set_hands(float muscle_tone, const Vec3f& laryngeal_pressure);
    /// Gathers the loads of a step; `proxy` is that step's, `blade` and `tissue` are as of the last. A
    /// contact of the proxy has `contact_stiffness` [N/m].
    void gather_loads(const ProxySnapshot& proxy, float contact_stiffness, const BladeContact& blade,
                      const PosedShell& shell, const SoftTissue& tissue);
    /// Whether the bones move, muscles have yet to relax, or loads have changed since the last solve.
    [[nodiscard]] bool needs_step() const;

    /// Encloses each solve of the mesh, of `dt` [s], once its contacts are found.
    void begin_solve(SoftTissue& tissue, const Walls& walls, float dt);
    void end_solve(SoftTissue& tissue, float dt);

    /// Whether the bones have moved by more than `distance` [m] anywhere since the `last` offsets; if so,
    /// updates these.
    [[nodiscard]] bool has_moved(float distance, YieldingSkeleton::Vector& last) const;
    /// Moves tissue outside the mesh that bone holds, once the bones have moved by so much that it counts.
    void hold(SoftTissue& tissue);

  private:
    struct Held {
        std::uint32_t particle;
        YieldingSkeleton::Carrier carrier;
    };
    [[nodiscard]] YieldingSkeleton::Carrier carrier_of(std::uint32_t particle) const {
        return {patient_.particles.bones[particle], hyoid_share_[particle]};
    }
    void place(const std::vector<Held>& held, SoftTissue& tissue) const;

    const patient::Patient& patient_;
    YieldingSkeleton skeleton_;
    std::vector<bool> in_mesh_;           // [particles]: corner of the mesh
    std::vector<float> hyoid_share_;      // [particles]
    std::vector<Held> of_mesh_, others_;  // particles that bone holds
    float muscle_tone_ = 0.0f;
    bool tone_changed_ = false;                 // since the last solve
    Vec3f laryngeal_pressure_ = Vec3f::Zero();  // [N]
    YieldingSkeleton::Vector held_at_ = YieldingSkeleton::Vector::Zero();
    YieldingSkeleton::Vector solved_load_ = YieldingSkeleton::Vector::Zero();
};

}  // namespace eti::scene
