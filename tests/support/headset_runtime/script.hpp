// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::headset_runtime {

/// Head pose at a frame; interpolated linearly between keyframes. Metres, in the room.
struct HeadKeyframe {
    double frame = 0.0;
    Vec3f position = Vec3f::Zero();
    float pitch = 0.0f;  ///< [rad], up
};

/// An input's value from this frame on; two numbers for a pad.
struct InputKeyframe {
    double frame = 0.0;
    std::string input;
    std::array<float, 2> value{};
};

/// A hand's aim pose from this frame on: it points along -z from here; in the room.
struct AimKeyframe {
    double frame = 0.0;
    std::string hand;  ///< "/user/hand/left" or "/user/hand/right"
    RigidTransform aim;
};

/// A session event. `life`: index of the instance, from 0.
struct Event {
    double frame = 0.0;
    std::string what;  ///< blur focus hide show sleep recentre leave lose_headset lose_runtime
    int life = 0;
};

/// The test's script: FOLDER/script.json, where ETI_HEADSET_FOLDER names the folder.
struct Script {
    int eye_width = 320, eye_height = 320;
    bool layered = true;  ///< images may have two layers
    int absent = 0;       ///< number of times that xrGetSystem reports no headset
    int pace_ms = 0;      ///< minimum real time per frame
    float between_eyes = 0.064f;
    std::array<float, 4> left_fov{-0.85f, 0.75f, 0.80f,
                                  -0.90f};  ///< left, right, up, down [rad]; mirrored for the other eye
    std::string controller = "/interaction_profiles/htc/vive_controller";
    std::vector<HeadKeyframe> head{{}};
    std::vector<InputKeyframe> hands;
    std::vector<AimKeyframe> aims;
    std::vector<Event> events;
    std::set<int> pictures;  ///< frames whose images are saved

    [[nodiscard]] RigidTransform head_at(double frame) const;
    [[nodiscard]] std::array<float, 2> input_at(const std::string& input, double frame) const;
    /// Empty when the hand is not tracked.
    [[nodiscard]] std::optional<RigidTransform> aim_at(const std::string& hand, double frame) const;
};

/// Throws nlohmann_json's exceptions.
[[nodiscard]] Script read_script(const std::filesystem::path& file);

}  // namespace eti::headset_runtime
