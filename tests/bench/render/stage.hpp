// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/view/scene_view.hpp"
#include "tests/bench/render/attempt.hpp"

namespace eti::bench {

/// What a client has of an attempt before any state comes: by the messages that a server sends.
[[nodiscard]] view::SceneView staged(const Attempt& attempt);

/// The same with the state of a moment, brought up to date. Throws std::runtime_error where the client
/// refuses a message.
[[nodiscard]] view::SceneView staged(const view::SceneView& rest, const Moment& moment);

}  // namespace eti::bench
