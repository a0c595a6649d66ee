// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "client/view/scene_view.hpp"

namespace eti::bench {

/// Chunks of deformation in the order in which one reader got them.
using Chunks = std::vector<msg::DeformationState>;

/// The file is there once it is whole. Throw std::runtime_error when it cannot be written or read.
void keep(const std::filesystem::path& file, const Chunks& chunks);
[[nodiscard]] Chunks kept(const std::filesystem::path& file);

/// Of the chunks and states that one reader got, how many another did; and how far the surfaces that the
/// other draws lie from the one's [mm], after every state. `rest`: the complete scene before any of them.
[[nodiscard]] nlohmann::json drawn_error(const view::SceneView& rest, const Chunks& whole,
                                         const Chunks& other);

}  // namespace eti::bench
