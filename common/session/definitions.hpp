// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/hdf5/group.hpp"
#include "common/session/record.hpp"

namespace eti::session {

/// The definitions of this program. `time_limit` [s]: the scenario's limit per attempt.
[[nodiscard]] Definitions current_definitions(double time_limit);

/// Throws hdf5::Error.
void write_definitions(const hdf5::Group& scene, const Definitions& definitions);
/// Version 0 and nothing else if the file has none. Throws hdf5::Error.
[[nodiscard]] Definitions read_definitions(const hdf5::Group& scene);

}  // namespace eti::session
