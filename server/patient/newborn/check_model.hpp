// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// One thing that must hold of a model.
struct Invariant {
    std::string name;
    bool holds = false;
    std::string found;  ///< counts, the worst value, and where a fault lies [mm]
};

/// Everything that must hold of a model for the server to run it and for its tissue to behave: surfaces and
/// shell closed, manifold, oriented, free of crossings; the epiglottis carried by its own cluster alone (Xiao
/// et al. 2020, section 4.2); tissue hung on bone; weights that sum to one; distances that agree with
/// the shell, and no way out of the mouth through it; an open way from the mouth to the carina. Some seconds.
[[nodiscard]] std::vector<Invariant> check_model(const Patient& patient);

}  // namespace eti::anatomy
