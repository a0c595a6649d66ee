// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::bench {

/// Force of a device's law on a blade pressed into the patient's tongue, against that of finite elements.
struct LawForce {
    std::string law;         ///< "constraint" or "displacement"
    double depth = 0.0;      ///< [m]
    double force = 0.0;      ///< [N], along the blade's path
    double reference = 0.0;  ///< [N]
};

/// Presses the tongue of the scenario `term`, as shipped, and evaluates both laws of the haptic loop on its
/// contacts.
[[nodiscard]] std::vector<LawForce> tongue_laws(bool quick);

}  // namespace eti::bench
