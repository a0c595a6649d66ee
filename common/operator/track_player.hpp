// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/math/random.hpp"
#include "common/operator/operator.hpp"

namespace eti {

/// Plays one hand of a script: maps observations to the pose that the hand wants. Deterministic in script,
/// seed and observations. The pose is that of the tool's frame (laryngoscope: see Laryngoscope; tube: grip,
/// see Tube).
class TrackPlayer {
  public:
    /// Plays the hand of `tool` in the attempts of a script, one after another as long as the tube is not in
    /// the trachea at an attempt's end. `seed`: for the tremors and the attempts' deviations. `tool_length`,
    /// `curvature`: see below.
    TrackPlayer(const OperatorScript& script, Tool tool, float tool_length, float curvature,
                std::uint64_t seed);

    /// Plays one track. `tool_length` [m]: from the tool frame's origin along the tool to its tip (blade
    /// length; grip to tip). `curvature` [1/m]: of the tool towards +y; 0 for a blade, 1 / curve_radius for a
    /// tube.
    TrackPlayer(const Track& track, float tool_length, float tremor, float reaction, std::uint64_t seed,
                float curvature = 0.0f);

    /// Wanted pose at `observation.time`; call with non-decreasing times.
    [[nodiscard]] RigidTransform wanted(const Observation& observation);

    [[nodiscard]] bool finished() const;
    /// Number of the attempt, from 1.
    [[nodiscard]] std::size_t attempt() const { return attempt_ + 1; }
    [[nodiscard]] bool aborted() const { return aborted_; }
    [[nodiscard]] const std::string& stage_name() const;

  private:
    struct Line {
        double frequency = 0.0, phase = 0.0;  // [rad/s], [rad]
        float amplitude = 0.0f;               // [m]
    };
    static constexpr std::size_t tremor_lines = 6;

    [[nodiscard]] RigidTransform along_tool(float length) const;
    /// Arc length [m] along the tool at `pose` to the position closest to `point`.
    [[nodiscard]] float arc_length_to(const RigidTransform& pose, const Vec3f& point) const;
    [[nodiscard]] Vec3f tip_target(const Stage& stage, const Observation& observation,
                                   const Landmarks& points) const;
    [[nodiscard]] RigidTransform target_of(const Stage& stage, const Observation& observation,
                                           const Landmarks& points, const RigidTransform& previous) const;
    [[nodiscard]] RigidTransform between(float share) const;
    [[nodiscard]] float blade_past(const Stage& stage, const Observation& observation) const;
    [[nodiscard]] bool conditions_met(const Stage& stage, const Observation& observation);
    /// Share of `time` [s] that has passed since the last call, at most 1.
    [[nodiscard]] float share_passed(const Observation& observation, double time) const;
    /// Share of a visible error that a hand corrects in this call; small even after a long pause between
    /// calls.
    [[nodiscard]] float correction(const Observation& observation) const;
    void begin_stage(const Observation& observation);
    void follow(const Stage& stage, const Observation& observation);
    void steer(const Stage& stage, const Observation& observation);
    void lean(const Observation& observation);
    [[nodiscard]] RigidTransform steered(const RigidTransform& pose, const Observation& observation) const;
    void next_stage();
    /// Starts the next attempt if this one failed.
    void start_next_attempt(const Observation& observation);
    /// Whether this hand's next attempt starts by withdrawing its tool from the mouth.
    [[nodiscard]] bool withdraws_tool() const;
    [[nodiscard]] const Track& track() const { return attempts_[attempt_]; }
    [[nodiscard]] bool stages_done() const { return stage_ >= track().stages.size(); }

    TrackPlayer(const std::vector<OperatorScript>& attempts, Tool tool, float tool_length, float curvature,
                std::uint64_t seed);
    /// Tracks of the attempts, at least one.
    TrackPlayer(std::vector<Track> attempts, float tool_length, float tremor, float reaction,
                std::uint64_t seed, float curvature);

    std::vector<Track> attempts_;  // never empty
    std::size_t attempt_ = 0;
    float tool_length_;
    float curvature_;
    RigidTransform tip_;  // tool frame: the tip, with +z tangential
    float reaction_;
    std::array<std::array<Line, tremor_lines>, 3> tremor_;
    std::size_t stage_ = 0;
    bool placed_ = false;
    bool begun_ = false;  // the current stage has its target
    bool aborted_ = false;
    Landmarks seen_{};  // the landmarks the stage aims at
    RigidTransform from_, target_, nominal_;
    Vec3f led_ = Vec3f::Zero();      // [m], tool frame; the point that moves straight from from_ to target_
    Vec3f aside_ = Vec3f::Zero();    // [m], from the visible tip to the line along which it is steered
    Vec3f steered_ = Vec3f::Zero();  // [m], accumulated steering of the tip
    float leaning_ = 0.0f;           // [m], to the tool's left, against the sideways force on its tip
    double started_ = 0.0, duration_ = 0.0;  // [s], of the current stage's motion
    double met_since_ = -1.0;                // [s], when the until conditions became true
    double last_time_ = 0.0;
    bool over_ = false;           // no further attempt is needed
    double attempt_began_ = 0.0;  // [s]
    double waits_since_ = -1.0;   // [s], start of the wait for the decision on a further attempt
    double clear_since_ = -1.0;   // [s], since both tools have been out of the mouth
};

}  // namespace eti
