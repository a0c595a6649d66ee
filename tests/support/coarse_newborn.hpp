// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/run/patient_cache.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::test {

/// Coarse enough to build the newborn within seconds.
inline constexpr patient::BuildSettings coarse_build{
    .spacing = 3.5e-3f, .fine_spacing = 2e-3f, .surface_spacing = 2.5e-3f};

/// The built-in newborn, from the patient cache if another program has built it already.
inline const patient::Patient& coarse_newborn() {
    static const patient::Patient patient = app::cached_patient({}, coarse_build);
    return patient;
}

}  // namespace eti::test
