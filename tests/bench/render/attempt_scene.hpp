// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/view/scene_view.hpp"
#include "tests/bench/render/attempt.hpp"

namespace eti::bench {

/// A client's scene before the first state, built from a server's messages.
[[nodiscard]] view::SceneView scene_of(const Attempt& attempt);

/// The same with the state of a moment applied. Throws std::runtime_error when the client rejects a message.
[[nodiscard]] view::SceneView scene_of(const view::SceneView& rest, const KeyMoment& moment);

}  // namespace eti::bench
