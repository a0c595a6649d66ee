// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "client/sound/score.hpp"

namespace eti::sound {

/// Plays what a session sounds like, by OpenAL, on a thread of its own: beats stay even however long a
/// picture takes.
class Player {
  public:
    /// Null where there is no device to play on. `volume` from 0 to 1.
    [[nodiscard]] static std::unique_ptr<Player> open(float volume);
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// What is to be heard from now on.
    void hear(const Cue& cue);

  private:
    struct Impl;
    explicit Player(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::sound
