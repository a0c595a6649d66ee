// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <optional>

#include "client/sound/player.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Sounds of a session's current state; none while the server is lost or not running.
[[nodiscard]] sound::Cue cue_of(const view::SceneView& scene, bool server_lost);

/// Opens the sound player; null if not `wanted` or if there is no audio device, which is reported if sound
/// was requested.
[[nodiscard]] std::unique_ptr<sound::Player> session_sound(std::optional<bool> wanted, float volume);

}  // namespace eti::client
