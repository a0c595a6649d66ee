// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/track_player.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/math/axes.hpp"
#include "common/operator/skill.hpp"

namespace eti {

namespace {

constexpr float way_in = 0.04f;        // [m], from the first rest pose to the first stage's target
constexpr float angular_speed = 2.0f;  // [rad/s], of a careful wrist
// A minimum-jerk move (Flash & Hogan 1985) peaks at 15/8 of its mean speed.
constexpr float peak_over_mean = 1.875f;
constexpr double follow_time = 0.1;         // [s], low pass on landmarks that a stage follows
constexpr double correction_time = 0.3;     // [s], time constant of a visual correction
constexpr float max_steering = 8e-3f;       // [m], of the tip
constexpr float max_turn = 0.5f;            // [rad], about the lips
constexpr float corrected_within = 20e-3f;  // [m], of the tip from its aim; no correction beyond
constexpr float least_swing = 3e-3f;        // [m]; rolling a straighter tube would not steer it
// Between attempts: the tube is in the trachea where an attempt counts as a success. A tool is out of the
// mouth where it cannot count as inside, with a margin (chosen).
constexpr float placed_depth = 10e-3f;     // [m] past the glottis
constexpr float blade_out = 30e-3f;        // [m], of a point of the blade from the mouth opening
constexpr float shortest_blade = 0.076f;   // [m], position of that point; a longer blade's tip is nearer
constexpr float tube_out = 20e-3f;         // [m]
constexpr double breather = 1.0;           // [s], between attempts
constexpr double decision_timeout = 30.0;  // [s], for the other hand
// A hand without a track holds its tool here, clear of the patient [m].
const Vec3f parked(0.0f, -0.3f, 0.2f);

float minimum_jerk(double t) {
    const double u = std::clamp(t, 0.0, 1.0);
    return static_cast<float>(u * u * u * (10.0 - 15.0 * u + 6.0 * u * u));
}

/// Length scale of the observed newborn relative to one of `reference` [kg]; 1 where either weight is
/// unknown.
float size_of(const Observation& observation, float reference) {
    // The rule's depth is weight plus 6, in cm.
    const double weight = 100.0 * static_cast<double>(observation.tube_depth_rule) - 6.0;
    if (!(weight > 0.0) || !(reference > 0.0f)) {
        return 1.0f;
    }
    // Rounded to the gram: the depth was rounded in transmission, and the reference newborn must have scale
    // 1.
    return static_cast<float>(
        std::cbrt(std::round(1e3 * weight) / std::round(1e3 * static_cast<double>(reference))));
}

std::vector<Track> tracks_of(const std::vector<OperatorScript>& attempts, Tool tool) {
    std::vector<Track> tracks;
    for (const OperatorScript& attempt : attempts) {
        tracks.push_back(tool == Tool::tube ? attempt.tube : attempt.laryngoscope);
    }
    return tracks;
}

}  // namespace

TrackPlayer::TrackPlayer(const OperatorScript& script, Tool tool, float tool_length, float curvature,
                         std::uint64_t seed)
    : TrackPlayer(make_attempts(script, seed), tool, tool_length, curvature,
                  // Each hand has its own tremor.
                  seed + (tool == Tool::tube ? 1 : 0)) {}

TrackPlayer::TrackPlayer(const std::vector<OperatorScript>& attempts, Tool tool, float tool_length,
                         float curvature, std::uint64_t seed)
    : TrackPlayer(tracks_of(attempts, tool), tool_length, attempts.front().tremor, attempts.front().reaction,
                  seed, curvature) {}

TrackPlayer::TrackPlayer(const Track& track, float tool_length, float tremor, float reaction,
                         std::uint64_t seed, float curvature)
    : TrackPlayer(std::vector<Track>{track}, tool_length, tremor, reaction, seed, curvature) {}

TrackPlayer::TrackPlayer(std::vector<Track> attempts, float tool_length, float tremor, float reaction,
                         std::uint64_t seed, float curvature)
    : attempts_(std::move(attempts)), tool_length_(tool_length), curvature_(curvature), reaction_(reaction) {
    tip_ = along_tool(tool_length);
    nominal_.translation = parked;
    // A sum of sines depends on time alone, so the tremor does not depend on the call rate.
    Random random(seed);
    const float amplitude = tremor / std::sqrt(3.0f) * std::sqrt(2.0f / tremor_lines);
    for (auto& axis : tremor_) {
        for (Line& line : axis) {
            line = {2.0 * std::numbers::pi * (8.0 + 4.0 * random.uniform()),
                    2.0 * std::numbers::pi * random.uniform(), amplitude};
        }
    }
}

RigidTransform TrackPlayer::along_tool(float length) const {
    return along_arc(curvature_, length);
}

float TrackPlayer::arc_length_to(const RigidTransform& pose, const Vec3f& point) const {
    return eti::arc_length_to(curvature_, pose.inverse() * point);
}

Vec3f TrackPlayer::tip_target(const Stage& stage, const Observation& observation,
                              const Landmarks& points) const {
    return at(points, stage.tip_at) + size_of(observation, track().weight) * stage.tip_offset +
           stage.tip_fixed_offset;
}

RigidTransform TrackPlayer::target_of(const Stage& stage, const Observation& observation,
                                      const Landmarks& points, const RigidTransform& previous) const {
    RigidTransform pose = previous;
    const float size = size_of(observation, track().weight);
    if (!stage.keep) {
        const Vec3f from =
            at(points, stage.axis_from) + size * stage.axis_from_offset + stage.axis_from_fixed_offset;
        const Vec3f tip = tip_target(stage, observation, points);
        const Vec3f line = (stage.axis_to_tip ? tip : at(points, stage.axis_to)) - from;
        // A curved tool passes through `from` and ends at the tip: the angle from the chord to the tangent at
        // its end is half the arc's angle. A point farther back than the tool's length counts as its origin.
        const float half_chord = std::min(line.norm(), tip_.translation.norm()) / 2.0f;
        const float bend = stage.axis_to_tip ? std::asin(std::min(1.0f, half_chord * curvature_)) : 0.0f;
        const Quatf pointing(Quatf(tool_axes(line)) * Quatf(Eigen::AngleAxisf(-bend, Vec3f::UnitX())));
        pose = RigidTransform{pointing.normalized(), tip} * tip_.inverse();
    }
    // Turns about the tool's own axes: about +x the tip moves to -y, so raising it is a negative turn.
    const Vec3f pivot = stage.pivot_at_tip ? pose * tip_.translation : at(points, stage.pivot);
    const Quatf turn(Eigen::AngleAxisf(-stage.pitch, pose.rotation * Vec3f::UnitX()) *
                     Eigen::AngleAxisf(stage.yaw, pose.rotation * Vec3f::UnitY()) *
                     Eigen::AngleAxisf(stage.roll, pose.rotation * Vec3f::UnitZ()));
    pose = RigidTransform{turn, pivot - turn * pivot} * pose;
    pose.translation += size * stage.lift * (pose.rotation * Vec3f::UnitY());
    pose = pose * along_tool(size * stage.advance);
    const float depth = stage.depth_by_rule ? observation.tube_depth_rule : size * stage.depth_at_lip;
    if (depth > 0.0f) {
        const float outside = arc_length_to(pose, at(points, Landmark::mouth_opening));
        pose = pose * along_tool(outside - (tool_length_ - depth));
    }
    if (stage.withdraw >= 0.0f) {
        const float outside = arc_length_to(pose, at(points, Landmark::mouth_opening));
        pose = pose * along_tool(std::min(0.0f, outside - tool_length_ - stage.withdraw));
    }
    return pose;
}

void TrackPlayer::begin_stage(const Observation& observation) {
    const Stage& stage = track().stages[stage_];
    from_ = nominal_;
    seen_ = observation.landmarks;
    target_ = target_of(stage, observation, seen_, target_);
    // A turn about a landmark keeps that landmark fixed in the tool frame; all other motion leads the tip.
    const Vec3f& tip = tip_.translation;
    led_ = stage.keep && !stage.pivot_at_tip ? target_.inverse() * at(seen_, stage.pivot) : tip;
    const float turn = rotation_vector(target_.rotation * from_.rotation.conjugate()).norm();
    const float path = (target_ * led_ - from_ * led_).norm() + turn * (tip - led_).norm();
    started_ = observation.time;
    duration_ =
        static_cast<double>(peak_over_mean) * std::max({path / stage.speed, turn / angular_speed, 1e-3f});
    met_since_ = -1.0;
    begun_ = true;
}

RigidTransform TrackPlayer::between(float share) const {
    const Quatf rotation = from_.rotation.slerp(share, target_.rotation);
    const Vec3f at_share = from_ * led_ + share * (target_ * led_ - from_ * led_);
    return {rotation, at_share - rotation * led_};
}

// Distance of the blade's tip, as constrained by the shell, beyond the stage's aim.
float TrackPlayer::blade_past(const Stage& stage, const Observation& observation) const {
    const Vec3f aim = observation.proxy.inverse() * at(observation.landmarks, stage.tip_at);
    return tip_.translation.z() - aim.z();
}

bool TrackPlayer::conditions_met(const Stage& stage, const Observation& observation) {
    const float size = size_of(observation, track().weight);
    const bool now =
        (stage.until_view_percent < 0.0f ||
         observation.glottic_opening_percent >= stage.until_view_percent) &&
        (stage.until_tube_depth < 0.0f ||
         observation.tube_depth_past_glottis >= size * stage.until_tube_depth) &&
        (stage.until_tube_aside < 0.0f || aside_.norm() <= stage.until_tube_aside) &&
        (stage.until_blade_past < 0.0f || blade_past(stage, observation) >= size * stage.until_blade_past) &&
        (stage.until_time < 0.0f ||
         observation.time - attempt_began_ >= static_cast<double>(stage.until_time));
    if (!now) {
        met_since_ = -1.0;
        return false;
    }
    if (met_since_ < 0.0) {
        met_since_ = observation.time;
    }
    const bool waits =
        stage.until_view_percent >= 0.0f || stage.until_tube_depth >= 0.0f || stage.until_blade_past >= 0.0f;
    return !waits || observation.time - met_since_ >= static_cast<double>(reaction_);
}

float TrackPlayer::share_passed(const Observation& observation, double time) const {
    return static_cast<float>(std::clamp((observation.time - last_time_) / time, 0.0, 1.0));
}

float TrackPlayer::correction(const Observation& observation) const {
    return std::min(share_passed(observation, correction_time), 0.1f);
}

void TrackPlayer::follow(const Stage& stage, const Observation& observation) {
    const float share = share_passed(observation, follow_time);
    for (std::size_t i = 0; i < landmark_count; ++i) {
        seen_[i] += share * (observation.landmarks[i] - seen_[i]);
    }
    target_ = target_of(stage, observation, seen_, target_);
}

// Gradually corrects the visible sideways distance of the tip from the line through the stage's aim into the
// trachea.
void TrackPlayer::steer(const Stage& stage, const Observation& observation) {
    const Landmarks& points = observation.landmarks;
    const Vec3f into_trachea =
        (at(points, Landmark::trachea_mid) - at(points, Landmark::glottis)).normalized();
    const Vec3f to_aim = tip_target(stage, observation, points) - observation.tube_tip;
    aside_ = to_aim - into_trachea * into_trachea.dot(to_aim);
    // Farther away, the path brings the tip near; past the cords, the trachea guides it.
    if (to_aim.norm() > corrected_within || observation.tube_depth_past_glottis > 0.0f) {
        return;
    }
    steered_ += track().steering * correction(observation) * aside_;
    steered_ *= std::min(1.0f, max_steering / std::max(steered_.norm(), 1e-9f));
}

// Turns the tool so that its tip moves by steered_. All turns are about the point where it passes the lips:
// whatever supports it farther down, the tip then follows the hand. Rolled between the fingers, a curved tube
// swings its tip sideways and hardly moves where it lies on the blade. Rolling is therefore used as far as
// possible.
RigidTransform TrackPlayer::steered(const RigidTransform& pose, const Observation& observation) const {
    const Vec3f& mouth = at(observation.landmarks, Landmark::mouth_opening);
    const RigidTransform lips = pose * along_tool(arc_length_to(pose, mouth));
    const Vec3f arm = pose * tip_.translation - lips.translation;
    const Vec3f axis = lips.rotation * Vec3f::UnitZ();
    const Vec3f swing = axis.cross(arm);
    const float roll = swing.norm() > least_swing ? swing.dot(steered_) / swing.squaredNorm() : 0.0f;
    const Vec3f rest = steered_ - roll * swing;
    // With the tip nearly out of the lips there is hardly any lever arm, and a hand does not compensate by
    // turning farther.
    Vec3f aside = arm.cross(rest) / std::max(arm.squaredNorm(), 1e-6f);
    aside *= std::min(1.0f, max_turn / std::max(aside.norm(), 1e-9f));
    const Quatf turn = quaternion_from(roll * axis + aside);
    return RigidTransform{turn, lips.translation - turn * lips.translation} * pose;
}

// Tissue that slides off one side of a blade pushes it to the other, increasingly with its distance; a hand
// that does not lean against it loses the tongue.
void TrackPlayer::lean(const Observation& observation) {
    const Vec3f missed = nominal_ * tip_.translation - observation.proxy * tip_.translation;
    // Farther away, the blade is not where the hand holds it, or is not visible yet.
    if (missed.norm() < corrected_within) {
        leaning_ += correction(observation) * missed.dot(nominal_.rotation * Vec3f::UnitX());
        leaning_ = std::clamp(leaning_, -track().lean, track().lean);
    }
}

RigidTransform TrackPlayer::wanted(const Observation& observation) {
    if (track().stages.empty()) {
        return nominal_;
    }
    if (stages_done() && !finished()) {
        start_next_attempt(observation);
    }
    if (!placed_) {
        target_ = target_of(track().stages.front(), observation, observation.landmarks, {});
        nominal_ = target_ * along_tool(-way_in);
        placed_ = true;
    }
    if (!stages_done()) {
        if (!begun_) {
            begin_stage(observation);
        }
        const Stage& stage = track().stages[stage_];
        if (stage.follow && !stage.keep) {
            follow(stage, observation);
        }
        if (stage.steer) {
            steer(stage, observation);
        } else if (!stage.keep || stage.withdraw >= 0.0f) {
            steered_ *= 1.0f - share_passed(observation, correction_time);
        }
        const double since = observation.time - started_;
        nominal_ = between(minimum_jerk(since / duration_));
        const double waited = since - duration_;
        // A hand that watches tube or blade advance, or lifts for a view, stops when that is reached, even
        // short of the end of the path.
        const bool watches = stage.until_tube_depth >= 0.0f || stage.until_blade_past >= 0.0f ||
                             (stage.keep && stage.until_view_percent >= 0.0f);
        if (waited >= 0.0 || watches) {
            const bool met = conditions_met(stage, observation);
            if (waited < 0.0 && met) {
                target_ = nominal_;
                next_stage();
            } else if (met && waited >= static_cast<double>(stage.hold)) {
                next_stage();
            } else if (!met && waited >= static_cast<double>(stage.timeout)) {
                if (stage.abort_on_timeout && stage_ + 1 < track().stages.size()) {
                    aborted_ = true;
                    stage_ = track().stages.size() - 2;
                }
                next_stage();
            }
        }
    }
    if (track().lean > 0.0f) {
        lean(observation);
    }
    last_time_ = observation.time;
    RigidTransform pose = steered_.isZero(0.0f) ? nominal_ : steered(nominal_, observation);
    pose.translation += leaning_ * (pose.rotation * Vec3f::UnitX());
    for (int k = 0; k < 3; ++k) {
        for (const Line& line : tremor_[static_cast<std::size_t>(k)]) {
            pose.translation[k] +=
                line.amplitude * static_cast<float>(std::sin(line.frequency * observation.time + line.phase));
        }
    }
    return pose;
}

void TrackPlayer::next_stage() {
    ++stage_;
    begun_ = false;
}

// Each hand decides from what both observe, so one process or two give the same result.
void TrackPlayer::start_next_attempt(const Observation& observation) {
    if (waits_since_ < 0.0) {
        waits_since_ = observation.time;
    }
    over_ = observation.tube_depth_past_glottis >= placed_depth ||
            observation.time - waits_since_ > decision_timeout;
    const Vec3f& mouth = at(observation.landmarks, Landmark::mouth_opening);
    const Vec3f blade = observation.proxy * Vec3f(0.0f, 0.0f, shortest_blade);
    const float size = size_of(observation, track().weight);
    // The tube goes first: the blade's hand waits until the tube is out.
    const bool drawn_back = withdraws_tool() || (observation.tube_tip - mouth).norm() > tube_out;
    if (over_ || !drawn_back || (blade - mouth).norm() < size * blade_out) {
        clear_since_ = -1.0;
        return;
    }
    if (clear_since_ < 0.0) {
        clear_since_ = observation.time;
    }
    if (observation.time - clear_since_ >= breather) {
        ++attempt_;
        stage_ = 0;
        begun_ = aborted_ = false;
        waits_since_ = clear_since_ = -1.0;
        attempt_began_ = observation.time;
    }
}

bool TrackPlayer::withdraws_tool() const {
    const std::vector<Stage>& next = attempts_[attempt_ + 1].stages;
    return !next.empty() && next.front().withdraw >= 0.0f;
}

bool TrackPlayer::finished() const {
    return stages_done() && (over_ || attempt_ + 1 == attempts_.size());
}

const std::string& TrackPlayer::stage_name() const {
    static const std::string none = "finished", between_attempts = "between attempts";
    return finished() ? none : stages_done() ? between_attempts : track().stages[stage_].name;
}

}  // namespace eti
