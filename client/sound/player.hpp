// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "client/sound/sound_scheduler.hpp"

namespace eti::sound {

/// Plays a session's sounds with OpenAL on its own thread: beats stay regular whatever the frame time.
class Player {
  public:
    /// Null if there is no audio device. `volume` from 0 to 1.
    [[nodiscard]] static std::unique_ptr<Player> open(float volume);
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// Sets the sounds to play from now on.
    void set_cue(const Cue& cue);

  private:
    struct Impl;
    explicit Player(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::sound
