// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/hdf5/group.hpp"
#include "common/session/record.hpp"

namespace eti::session {

/// Those of this program. `time_limit` [s]: of the scenario, for an attempt.
[[nodiscard]] Definitions definitions_here(double time_limit);

/// Throws hdf5::Error.
void write_definitions(const hdf5::Group& scene, const Definitions& definitions);
/// Version 0 and nothing else where the file has none. Throws hdf5::Error.
[[nodiscard]] Definitions read_definitions(const hdf5::Group& scene);

}  // namespace eti::session
