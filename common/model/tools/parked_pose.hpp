// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/tools/tools.hpp"

namespace eti {

/// Rest pose of a tool that is not in use: well clear of the face, patient frame.
[[nodiscard]] inline RigidTransform parked_pose(Tool tool) {
    return {Quatf::Identity(),
            tool == Tool::tube ? Vec3f(-0.12f, -0.25f, 0.10f) : Vec3f(0.0f, -0.25f, 0.15f)};
}

}  // namespace eti
