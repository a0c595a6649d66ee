// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/tools/tools.hpp"

namespace eti {

/// What a scripted hand may observe: the same that a person sees and feels.
struct Observation {
    double time = 0.0;  ///< [s], simulation time
    Landmarks landmarks = zero_landmarks();
    float glottic_opening_percent = 0.0f;
    Vec3f tube_tip = Vec3f::Zero();         ///< [m]
    float tube_depth_past_glottis = -1.0f;  ///< [m], negative before the cords
    RigidTransform proxy;                   ///< laryngoscope
    float tube_depth_rule = 0.0f;           ///< [m] at the lip, weight plus 6 cm; 0 while unknown
};

/// One stage of a track. A pose is defined by landmarks, not by coordinates. Lengths apply to a newborn of
/// the script's weight.
struct Stage {
    std::string name;
    // Tip position: landmark plus offset along the current left, posterior, superior axes [m].
    Landmark tip_at = Landmark::mouth_opening;
    Vec3f tip_offset = Vec3f::Zero();
    Vec3f tip_fixed_offset = Vec3f::Zero();  ///< [m], independent of the newborn's size: room for the tool
    // Axis of blade or tube: from a landmark to the tip, or towards another landmark.
    Landmark axis_from = Landmark::mouth_opening;
    Vec3f axis_from_offset = Vec3f::Zero();        ///< [m], as tip_offset
    Vec3f axis_from_fixed_offset = Vec3f::Zero();  ///< [m], as tip_fixed_offset
    bool axis_to_tip = true;  ///< the axis runs from axis_from to the tip's target, else to axis_to
    Landmark axis_to = Landmark::vallecula;
    bool follow = false;  ///< track the landmarks continuously instead of aiming once
    bool steer = false;   ///< turn the tube until its tip appears on the line through tip_at into the trachea
    bool keep = false;    ///< start from the previous stage's target and only add the following
    float lift = 0.0f;    ///< [m], along the handle
    float advance = 0.0f;  ///< [m], along the tool's axis; can push a tube past its landmark
    /// [m], withdraws the tool along its axis until its tip is this far before the mouth opening; a tool
    /// already there stays; negative: unused
    float withdraw = -1.0f;
    float depth_at_lip =
        -1.0f;  ///< [m], slides the tool along its axis until this length is past the mouth opening
    bool depth_by_rule = false;  ///< the same with the rule's depth, once it is known
    float pitch = 0.0f;          ///< [rad], tip up (towards the handle), about `pivot`
    float yaw = 0.0f;            ///< [rad]
    float roll = 0.0f;           ///< [rad]
    Landmark pivot = Landmark::upper_gum;
    bool pivot_at_tip = true;  ///< turn about the tool's tip, else about `pivot`
    float speed = 0.03f;       ///< [m/s] of the tip along its path
    float hold = 0.0f;         ///< [s] after arriving
    // Conditions for the next stage (all that are set must hold); `timeout` ends the wait in any case.
    float until_view_percent = -1.0f;
    float until_tube_depth = -1.0f;  ///< [m] past the glottis
    float until_tube_aside = -1.0f;  ///< [m], of the tip from the line along which it is steered
    float until_blade_past = -1.0f;  ///< [m], of the laryngoscope's tip past tip_at, along the blade
    float until_time = -1.0f;        ///< [s] since the start of the run
    float timeout = 10.0f;           ///< [s]
    bool abort_on_timeout = false;   ///< give up: skip the rest of the track up to the last stage
};

struct Track {
    std::vector<Stage> stages;
    /// [kg], of the newborn to which the stages' lengths apply; 0: any newborn.
    float weight = 0.0f;
    /// [m], largest sideways lean of a laryngoscope's hand against the force that pushes the tip sideways.
    float lean = 0.0f;
    float steering = 1.0f;  ///< share of the visible error of a steered tip that the hand corrects
};

/// How far a hand without any skill deviates from its script; a hand of skill s deviates by (1 - s) of it.
/// All values are chosen; docs/operators/skill.md describes how they are drawn.
struct Variation {
    float tremor = 0.3e-3f;  ///< [m], RMS, added
    float reaction = 0.4f;   ///< [s], added
    float path = 3e-3f;      ///< [m], standard deviation of each coordinate of the aim
    float speed = 0.4f;      ///< standard deviation of the speeds' logarithms, and mean slowdown
    float pause = 0.8f;      ///< [s], mean hesitation after each stage
    float lift = 0.6f;       ///< standard deviation of the missing share of the lift
    float lever = 0.2618f;   ///< [rad], standard deviation of the added levering on the gum
    float view = 0.8f;       ///< largest share of the wanted view that is foregone
    float steering = 1.0f;   ///< largest share of the tube's error that is left uncorrected
    float depth = 15e-3f;    ///< [m], standard deviation of the perceived depth of the tube
};

/// A scripted operator: a track for each hand, tremor, and the hand's impedance.
struct OperatorScript {
    std::string name;
    std::string description;
    Track laryngoscope;
    Track tube;
    float tremor = 0.0f;    ///< [m], RMS of the hand's physiological tremor (8-12 Hz)
    float reaction = 0.2f;  ///< [s], delay before a stage reacts to an observation
    std::uint64_t seed = 1;
    float skill = 1.0f;  ///< 0 to 1; 1 plays the script as written
    int attempts = 1;    ///< maximum number, while the tube is not in the trachea
    Variation variation;
};

inline constexpr int max_attempts = 9;

/// Reads and validates a script. Throws InputError instead of returning a partial one.
[[nodiscard]] OperatorScript load_operator(const std::filesystem::path& file);

/// The same from text. `file` is only used in errors, and gives the name where the text has none.
[[nodiscard]] OperatorScript parse_operator(const std::string& text, const std::filesystem::path& file);

}  // namespace eti
