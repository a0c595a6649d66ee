// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/units.hpp"
#include "common/model/tools/parked_pose.hpp"
#include "server/scene/scene.hpp"

namespace eti::test {

/// Both tools parked away from a newborn in this posture.
inline scene::Inputs parked_tools(float head_elevation_deg, float jaw_opening_deg) {
    scene::Inputs inputs;
    inputs.laryngoscope = parked_pose(Tool::laryngoscope);
    inputs.tube_grip = parked_pose(Tool::tube);
    inputs.runtime_parameters.head_elevation = head_elevation_deg * degree;
    inputs.runtime_parameters.jaw_opening = jaw_opening_deg * degree;
    return inputs;
}

/// The laryngoscope with its blade pointing posterior and its tip there.
inline RigidTransform blade_with_tip_at(const Vec3f& tip, const Laryngoscope& scope) {
    const Quatf posterior(Eigen::AngleAxisf(-90.0f * degree, Vec3f::UnitX()));
    return {posterior, tip - posterior * scope.tip()};
}

/// Steps with inputs that stay.
inline void hold(scene::Scene& scene, const scene::Inputs& inputs, int steps) {
    for (int k = 0; k < steps; ++k) {
        scene.step(inputs);
    }
}

}  // namespace eti::test
