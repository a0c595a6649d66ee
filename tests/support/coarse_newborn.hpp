// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/patient_cache.hpp"
#include "server/patient/newborn/build.hpp"

namespace eti::test {

/// Coarse enough to build the newborn in seconds.
inline constexpr anatomy::BuildSettings coarse_build{
    .spacing = 3.5e-3f, .fine_spacing = 2e-3f, .surface_spacing = 2.5e-3f};

/// The built-in newborn, from the cache of patients where a program before has built it.
inline const anatomy::Patient& coarse_newborn() {
    static const anatomy::Patient patient = app::cached_patient({}, coarse_build);
    return patient;
}

}  // namespace eti::test
