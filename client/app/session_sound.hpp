// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <optional>

#include "client/sound/player.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// What is heard of a session as it is; nothing while the server is lost or does not run.
[[nodiscard]] sound::Cue cue_of(const view::SceneView& scene, bool server_lost);

/// What plays it, or null: not `wanted`, or no device to play on, which is said where it was asked for.
[[nodiscard]] std::unique_ptr<sound::Player> session_sound(std::optional<bool> wanted, float volume);

}  // namespace eti::client
