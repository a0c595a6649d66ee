// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/scenario/scenario.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {

/// Build settings of a scenario's patient; shared by server and eti-anatomy.
[[nodiscard]] inline BuildSettings settings_of(const Scenario& scenario) {
    BuildSettings settings;
    settings.spacing = scenario.physics.spacing;
    settings.fine_spacing = scenario.physics.fine_spacing;
    settings.region = scenario.physics.region;
    settings.tissue_stiffness = scenario.runtime_parameters.tissue_stiffness;
    return settings;
}

}  // namespace eti::patient
