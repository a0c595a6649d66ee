// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "reader.hpp"
#include "server/patient/imaging/formats.hpp"

namespace eti::fuzz {

/// Outcome of `parse` for these bytes: a valid volume, or an error.
inline void read_volume(imaging::Volume (*parse)(std::span<const std::uint8_t>, const std::string&),
                        const std::uint8_t* data, std::size_t size) {
    const std::string name = "fuzzed";
    read_or_refuse<imaging::VolumeError>(name, [&] {
        const imaging::Volume volume = parse({data, size}, name);
        require(volume.value.size() == volume.geometry.count(), "voxels that do not fill the volume");
        imaging::require_valid(volume.geometry, name);
        imaging::require_finite(volume, name);
    });
}

}  // namespace eti::fuzz
