// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/hdf5/group.hpp"

namespace eti::session {

/// Rows of a series that a repair could not read. In `deformation`, `fluid` and `annotations` they are times,
/// numbered as before the repair, which removed them. Elsewhere they remain, filled with NaN, 0 or empty
/// texts; times and step numbers are interpolated linearly between their neighbours. For the scene, only
/// `path` is used.
struct Damage {
    std::string path;
    std::size_t first = 0, count = 0;
};

/// "tools/proxy_pose: rows 315 to 359 are lost".
[[nodiscard]] std::string describe(const Damage& damage);

[[nodiscard]] bool is_known_lost(const std::vector<Damage>& damage, std::string_view path);

/// The group `damage` of a repaired session file; a file without the group has no damage. Both throw
/// hdf5::Error.
void write_damage(const hdf5::Group& root, const std::vector<Damage>& damage);
[[nodiscard]] std::vector<Damage> read_damage(const hdf5::Group& root);

}  // namespace eti::session
