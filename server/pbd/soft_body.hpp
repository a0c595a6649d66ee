// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/pbd/constraint.hpp"
#include "server/pbd/links.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/shape_matching.hpp"
#include "server/pbd/sleep.hpp"
#include "server/pbd/tetrahedra.hpp"

namespace eti::pbd {

/// All soft tissue: particles with their constraints, advanced in substeps by the caller, who adds
/// contacts between project() and finish().
class SoftBody {
  public:
    struct Settings {
        float damping = 0.0f;  ///< [1/s], of velocity
        /// [m/s^2], of free particles, beyond the weight that the unloaded shape already bears.
        Vec3f acceleration = Vec3f::Zero();
    };

    Particles particles;
    ShapeMatching shapes;  ///< the tetrahedra's particles have to be its early ones
    Tetrahedra tetrahedra;
    Links links;
    std::vector<AnyConstraint> further;  ///< projected in this order, after the links
    Sleep sleep;                         ///< off before let_sleep(); whoever changes settings wakes the whole
    Settings settings;

    /// From now on what rests sleeps. All constraints have to be there. `mesh`: see Sleep::configure().
    void let_sleep(const std::vector<bool>& mesh, const Sleep::Settings& wanted);
    /// Once per step, before its substeps and after them, where sleep is on or constraints are further ones.
    void begin_step();
    void end_step();
    /// Moves free particles by their velocity; particles of infinite mass go the `fraction` of the
    /// remaining way to their rest position (1 on the last substep of a step).
    void predict(float dt, float fraction);
    /// One pass over all internal constraints.
    void project(float dt);
    /// Velocities from the motion of the substep.
    void finish(float dt);
    /// Takes particles.rest as the new unloaded shape.
    void set_rest();
    /// Everything back to rest, at standstill.
    void reset();

  private:
    /// body(constraint) for each, in the order of projection.
    template <class Body>
    void for_constraints(const Body& body) {
        body(links);
        for (AnyConstraint& constraint : further) {
            body(*constraint);
        }
    }
};

}  // namespace eti::pbd
