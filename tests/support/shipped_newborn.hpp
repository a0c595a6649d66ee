// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/run/patient_cache.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::test {

/// The built-in newborn at the server's resolution, from the patient cache if the same sources have built it
/// already: building takes a quarter of a minute of processor time.
inline const patient::Patient& shipped_newborn() {
    static const patient::Patient patient = app::cached_patient({}, {});
    return patient;
}

}  // namespace eti::test
