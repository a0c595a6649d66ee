// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// A condition that every model must satisfy.
struct Invariant {
    std::string name;
    bool holds = false;
    std::string found;  ///< counts, the worst value, and the location of a fault [mm]
};

/// Conditions under which the server can run a model and its tissue behaves correctly. Surfaces and shell are
/// closed, manifold, oriented and free of self-intersections; the epiglottis has its own cluster (Xiao et al.
/// 2020, section 4.2); tissue is attached to bone; weights sum to one. Distances agree with the shell; the
/// mouth has no leak through it, and the way from mouth to carina is open. Takes some seconds.
[[nodiscard]] std::vector<Invariant> check_model(const Patient& patient);

}  // namespace eti::patient
