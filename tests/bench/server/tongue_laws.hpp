// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::bench {

/// Force of a device's law on the blade that presses the patient's tongue, against the finite elements'.
struct LawForce {
    std::string law;         ///< "constraint" or "displacement"
    double depth = 0.0;      ///< [m]
    double force = 0.0;      ///< [N], along the blade's way
    double reference = 0.0;  ///< [N]
};

/// Presses the tongue of the scenario `term`, as the simulation ships it, and asks both laws of the haptic
/// loop what its contacts mean.
[[nodiscard]] std::vector<LawForce> tongue_laws(bool quick);

}  // namespace eti::bench
