// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

#include "server/patient/newborn/build/build.hpp"

namespace eti::app {

/// Folder of cached models: $ETI_CACHE, else $XDG_CACHE_HOME/neoeti, else ~/.cache/neoeti. If that does not
/// exist and cannot be created, as in a read-only home: neoeti-UID among temporary files, with access for
/// this user only.
[[nodiscard]] std::filesystem::path cache_folder();

/// The patient for these parameters, from the cache, or built (some seconds) and then cached. If the same
/// patient is cached with other spacings, only particles are built; with another stiffness, nothing. A cache
/// that cannot be read or written is reported and bypassed; it never stops the server.
[[nodiscard]] patient::Patient cached_patient(const NewbornShape& shape, patient::BuildSettings settings);

}  // namespace eti::app
