// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/pbd/constraint.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/soft/links.hpp"
#include "server/pbd/soft/shape_matching.hpp"
#include "server/pbd/soft/sleep.hpp"

namespace eti::pbd {

/// All soft tissue: particles and their constraints, advanced in substeps by the caller, who adds contacts
/// between project() and finish().
class SoftBody {
  public:
    struct Settings {
        float damping = 0.0f;  ///< [1/s], of velocity
        /// [m/s^2], of free particles, in addition to the weight that the unloaded shape already carries.
        Vec3f acceleration = Vec3f::Zero();
    };

    Particles particles;
    ShapeMatching shapes;
    Links links;
    std::vector<AnyConstraint> constraints;  ///< projected in this order, after the links
    Sleep sleep;  ///< off until enable_sleeping(); wake_all() after any change of settings
    Settings settings;

    /// Lets tissue at rest sleep from now on. All constraints must have been added. `mesh`: see
    /// Sleep::configure().
    void enable_sleeping(const std::vector<bool>& mesh, const Sleep::Settings& wanted);
    /// Call once before and once after a step's substeps where sleeping is enabled or `constraints` is not
    /// empty.
    void begin_step();
    void end_step();
    /// Moves free particles by their velocity; particles of infinite mass move by `fraction` of the remaining
    /// distance to their rest position (1 on the last substep of a step).
    void predict(float dt, float fraction);
    /// One pass over all internal constraints.
    void project(float dt);
    /// Computes velocities from the displacements of the substep.
    void finish(float dt);
    /// Adopts particles.rest as the new unloaded shape.
    void set_rest();
    /// Resets all particles to their rest positions, with zero velocity.
    void reset();

  private:
    /// Calls body(constraint) for each, in the order of projection.
    template <class Body>
    void for_constraints(const Body& body) {
        body(links);
        for (AnyConstraint& constraint : constraints) {
            body(*constraint);
        }
    }
};

}  // namespace eti::pbd
