// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "common/operator/track_player.hpp"
#include "tests/unit/common/operator/newborn_landmarks.hpp"

namespace eti {

inline constexpr float length = 0.1f;
inline constexpr float reaction = 0.2f;
inline constexpr double dt = 1e-3;

/// Plays a track for the landmarks of a newborn.
class Playing : public testing::Test {
  protected:
    // A stage that brings the tip to the vallecula along the line from the upper gum.
    static Stage stage_at(Landmark where) {
        Stage stage;
        stage.name = landmark_names[static_cast<std::size_t>(where)];
        stage.tip_at = where;
        stage.axis_from = Landmark::upper_gum;
        return stage;
    }

    static Stage kept(const char* name) {
        Stage stage;
        stage.name = name;
        stage.keep = true;
        return stage;
    }

    void begin(std::vector<Stage> stages) {
        player_.emplace(Track{std::move(stages)}, length, 0.0f, reaction, 1);
        seen_.landmarks = newborn_landmarks();
        seen_.time = 0;
        pose_ = player_->wanted(seen_);
    }

    void step() {
        seen_.time += dt;
        pose_ = player_->wanted(seen_);
    }

    void play(double seconds) {
        for (int i = 0; i < static_cast<int>(seconds / dt); ++i) {
            step();
        }
    }

    // Plays until the stage of this name begins; returns false when it does not within a minute.
    [[nodiscard]] bool play_until(const std::string& stage) {
        for (int i = 0; i < 60'000 && player_->stage_name() != stage; ++i) {
            step();
        }
        return player_->stage_name() == stage;
    }

    [[nodiscard]] Vec3f tip() const { return pose_ * Vec3f(0, 0, length); }
    [[nodiscard]] Vec3f handle() const { return pose_.rotation * Vec3f::UnitY(); }
    [[nodiscard]] Vec3f along() const { return pose_.rotation * Vec3f::UnitZ(); }
    [[nodiscard]] Vec3f landmark(Landmark which) const { return at(seen_.landmarks, which); }

    std::optional<TrackPlayer> player_;
    Observation seen_;
    RigidTransform pose_;
};

}  // namespace eti
