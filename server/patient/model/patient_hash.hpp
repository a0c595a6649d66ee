// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// FNV-1a over the bits of everything that a simulation uses of a patient; names and drawn surfaces are
/// excluded.
[[nodiscard]] std::uint64_t hash_of(const Patient& patient);

}  // namespace eti::patient
