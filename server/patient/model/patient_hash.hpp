// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// FNV-1a over the bits of all that a simulation takes from a patient; names and drawn surfaces are left out.
[[nodiscard]] std::uint64_t hash_of(const Patient& patient);

}  // namespace eti::anatomy
