// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/tools.hpp"

namespace eti {

/// What a scripted hand may look at: the same that a person sees and feels.
struct Observation {
    double time = 0.0;  ///< [s], simulation time
    Landmarks landmarks = unseen_landmarks();
    float glottic_opening_percent = 0.0f;
    Vec3f tube_tip = Vec3f::Zero();         ///< [m]
    float tube_depth_past_glottis = -1.0f;  ///< [m], negative before the cords
    RigidTransform proxy;                   ///< laryngoscope
    float tube_depth_rule = 0.0f;           ///< [m] at the lip, weight plus 6 cm; 0 while unknown
};

/// One stage of a track. A pose is built from landmarks, not from coordinates. Lengths are those of a newborn
/// of the script's weight.
struct Stage {
    std::string name;
    // Tip position: landmark plus offset along the current left, posterior, superior axes [m].
    Landmark tip_at = Landmark::mouth_opening;
    Vec3f tip_offset = Vec3f::Zero();
    Vec3f tip_fixed_offset = Vec3f::Zero();  ///< [m], the same in every newborn: room for the tool
    // Axis of blade or tube: from a landmark to the tip, or towards another landmark.
    Landmark axis_from = Landmark::mouth_opening;
    Vec3f axis_from_offset = Vec3f::Zero();        ///< [m], as tip_offset
    Vec3f axis_from_fixed_offset = Vec3f::Zero();  ///< [m], as tip_fixed_offset
    bool axis_to_tip = true;  ///< the axis runs from axis_from to the tip's target, else to axis_to
    Landmark axis_to = Landmark::vallecula;
    bool follow = false;  ///< track the landmarks live instead of aiming once
    bool steer = false;   ///< turn the tube until its tip is seen on the line through tip_at into the trachea
    bool keep = false;    ///< start from the previous stage's target and only add the below
    float lift = 0.0f;    ///< [m], along the handle
    float advance = 0.0f;  ///< [m], along the tool's axis; a tube may so be pushed past its landmark
    /// [m], draws the tool back along its axis until its tip lies so far before the mouth opening; what lies
    /// there already stays; negative: not
    float withdraw = -1.0f;
    float depth_at_lip =
        -1.0f;  ///< [m], slides the tool along its axis until so much lies past the mouth opening
    bool depth_by_rule = false;  ///< the same with the rule's depth, once that is known
    float pitch = 0.0f;          ///< [rad], tip up (towards the handle), about `pivot`
    float yaw = 0.0f;            ///< [rad]
    float roll = 0.0f;           ///< [rad]
    Landmark pivot = Landmark::upper_gum;
    bool pivot_at_tip = true;  ///< turn about the tool's tip, else about `pivot`
    float speed = 0.03f;       ///< [m/s] of the tip along its path
    float hold = 0.0f;         ///< [s] after arriving
    // Go on when these hold (all of those set); `timeout` ends waiting in any case.
    float until_view_percent = -1.0f;
    float until_tube_depth = -1.0f;  ///< [m] past the glottis
    float until_tube_aside = -1.0f;  ///< [m], of the tip from the line it is steered along
    float until_blade_past = -1.0f;  ///< [m], of the laryngoscope's tip past tip_at, along the blade
    float until_time = -1.0f;        ///< [s] since the start of the run
    float timeout = 10.0f;           ///< [s]
    bool abort_on_timeout = false;   ///< give up: the rest of the track is skipped up to the last stage
};

struct Track {
    std::vector<Stage> stages;
    /// [kg], of the newborn whose lengths the stages give; 0: they hold for any newborn.
    float weight = 0.0f;
    /// [m], how far a laryngoscope's hand leans sideways, at most, against what pushes the tip aside.
    float lean = 0.0f;
    float steering = 1.0f;  ///< share of what is seen of a steered tip's error that the hand makes up
};

/// By how much a hand without any skill strays from its script; one of skill s by (1 - s) of it. All of it is
/// chosen; docs/operators/skill.md says how it is drawn.
struct Variation {
    float tremor = 0.3e-3f;  ///< [m], RMS, on top
    float reaction = 0.4f;   ///< [s], on top
    float path = 3e-3f;      ///< [m], standard deviation of each coordinate of what is aimed at
    float speed = 0.4f;      ///< standard deviation of the speeds' logarithms, and how much slower they are
    float pause = 0.8f;      ///< [s], mean hesitation after each stage
    float lift = 0.6f;       ///< standard deviation of the share of the lift that is missing
    float lever = 0.2618f;   ///< [rad], standard deviation of the levering on the gum on top
    float view = 0.8f;       ///< largest share of the wanted view that is done without
    float steering = 1.0f;   ///< largest share of the tube's error that is left as it is
    float depth = 15e-3f;    ///< [m], standard deviation of how deep the tube is taken to be
};

/// A scripted operator: a track for each hand, tremor, and the hand's impedance.
struct OperatorScript {
    std::string name;
    std::string description;
    Track laryngoscope;
    Track tube;
    float tremor = 0.0f;    ///< [m], RMS of the hand's physiological tremor (8-12 Hz)
    float reaction = 0.2f;  ///< [s], delay before a stage reacts to what is seen
    std::uint64_t seed = 1;
    float skill = 1.0f;  ///< 0 to 1; 1 plays the script as it is written
    int attempts = 1;    ///< at most so many, while the tube does not lie in the trachea
    Variation variation;
};

inline constexpr int most_attempts = 9;

/// Reads and validates a script. Throws InputError; nothing is half-configured.
[[nodiscard]] OperatorScript load_operator(const std::filesystem::path& file);

/// The same from text; `file` is only named in errors, and gives the name where the text has none.
[[nodiscard]] OperatorScript parse_operator(const std::string& text, const std::filesystem::path& file);

}  // namespace eti
