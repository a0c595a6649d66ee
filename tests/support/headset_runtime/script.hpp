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

/// Where the head is at a frame; on a straight way between two of them. Metres, in the room.
struct HeadAt {
    double frame = 0.0;
    Vec3f position = Vec3f::Zero();
    float pitch = 0.0f;  ///< [rad], up
};

/// From this frame on an input has this value; two numbers for a pad.
struct HandDoes {
    double frame = 0.0;
    std::string input;
    std::array<float, 2> value{};
};

/// From this frame on a hand points from here along -z; in the room.
struct HandAims {
    double frame = 0.0;
    std::string hand;  ///< "/user/hand/left" or the right one
    RigidTransform aim;
};

/// What befalls the session. `life`: of which instance, the first is 0.
struct Event {
    double frame = 0.0;
    std::string what;  ///< blur focus hide show sleep recentre leave lose_headset lose_runtime
    int life = 0;
};

/// What a test wants to happen: FOLDER/script.json, where the folder is named by ETI_HEADSET_FOLDER.
struct Script {
    int eye_width = 320, eye_height = 320;
    bool layered = true;  ///< pictures may have two layers
    int absent = 0;       ///< so often the headset is not there when it is asked for
    int pace_ms = 0;      ///< of real time that a frame takes at least
    float between_eyes = 0.064f;
    std::array<float, 4> left_fov{-0.85f, 0.75f, 0.80f,
                                  -0.90f};  ///< left, right, up, down [rad]; the other mirrors it
    std::string controller = "/interaction_profiles/htc/vive_controller";
    std::vector<HeadAt> head{{}};
    std::vector<HandDoes> hands;
    std::vector<HandAims> aims;
    std::vector<Event> events;
    std::set<int> pictures;  ///< frames of which pictures are kept

    [[nodiscard]] RigidTransform head_at(double frame) const;
    [[nodiscard]] std::array<float, 2> input_at(const std::string& input, double frame) const;
    /// Nothing: it is not tracked.
    [[nodiscard]] std::optional<RigidTransform> aim_at(const std::string& hand, double frame) const;
};

/// Throws what nlohmann_json throws.
[[nodiscard]] Script read_script(const std::filesystem::path& file);

}  // namespace eti::headset_runtime
