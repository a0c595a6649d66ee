// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

#include "server/patient/newborn/build.hpp"

namespace eti::app {

/// Folder of built models: $ETI_CACHE, else $XDG_CACHE_HOME/neoeti, else ~/.cache/neoeti.
[[nodiscard]] std::filesystem::path cache_folder();

/// The patient for these parameters, from the cache or built anew (some seconds) and then cached. Of a
/// patient that is there with other spacings, particles alone are built; with another stiffness, nothing. A
/// cache that cannot be written or read is reported and does without; it never stops the server.
[[nodiscard]] anatomy::Patient cached_patient(const NewbornShape& shape, anatomy::BuildSettings settings);

}  // namespace eti::app
