// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "client/view/scene_view.hpp"

namespace eti::bench {

/// Deformation chunks in one reader's order of arrival.
using Chunks = std::vector<msg::DeformationState>;

/// The file appears once it is complete. Throw std::runtime_error when it cannot be written or read.
void save_chunks(const std::filesystem::path& file, const Chunks& chunks);
[[nodiscard]] Chunks load_chunks(const std::filesystem::path& file);

/// Share of one reader's chunks and states that another received, and the distance between the surfaces that
/// both draw [mm], after every state. `rest`: the complete scene before any of them.
[[nodiscard]] nlohmann::json surface_error(const view::SceneView& rest, const Chunks& whole,
                                           const Chunks& other);

}  // namespace eti::bench
