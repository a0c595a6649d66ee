// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "common/hdf5/group.hpp"
#include "common/session/record.hpp"

namespace eti::session {

/// Writes the start of a session file: kind, layout, `meta` (not yet finished) and `scene`.
void write_header(const hdf5::Group& root, const SessionInfo& info, const SceneRecord& scene,
                  std::uint64_t lost_records);

/// The groups `meta` and `scene` of a session file. All throw hdf5::Error.
void write_info(const hdf5::Group& meta, const SessionInfo& info);
[[nodiscard]] SessionInfo read_info(const hdf5::Group& meta);

void write_scene(const hdf5::Group& group, const SceneRecord& scene);
/// Validates indices, weights and finiteness.
[[nodiscard]] SceneRecord read_scene(const hdf5::Group& group);

}  // namespace eti::session
