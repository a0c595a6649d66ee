// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/patient_cache.hpp"
#include "server/patient/newborn/build.hpp"

namespace eti::test {

/// The built-in newborn as finely as a server has it, from the cache of patients where the same sources have
/// built it before: that takes a quarter of a minute of the processor.
inline const anatomy::Patient& shipped_newborn() {
    static const anatomy::Patient patient = app::cached_patient({}, {});
    return patient;
}

}  // namespace eti::test
