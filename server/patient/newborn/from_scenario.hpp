// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/scenario/scenario.hpp"
#include "server/patient/newborn/build.hpp"

namespace eti::anatomy {

/// How finely a scenario wants its patient cut. Server and eti-anatomy build alike.
[[nodiscard]] inline BuildSettings settings_of(const Scenario& scenario) {
    BuildSettings settings;
    settings.spacing = scenario.physics.spacing;
    settings.fine_spacing = scenario.physics.fine_spacing;
    settings.region = scenario.physics.region;
    settings.tissue_stiffness = scenario.live.tissue_stiffness;
    return settings;
}

}  // namespace eti::anatomy
