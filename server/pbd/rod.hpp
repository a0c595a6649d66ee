// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/model/tools.hpp"
#include "server/pbd/rod_chain.hpp"
#include "server/pbd/rod_contact.hpp"
#include "server/pbd/rod_joint.hpp"

namespace eti::pbd {

/// How fingers hold a rod: a spring that yields. Beyond `force` or `torque` the rod slips between them.
struct RodHold {
    float stiffness = 5e3f;  ///< [N/m]
    float turning = 2.0f;    ///< [N m/rad]
    float force = 5.0f;      ///< [N], the most that they hold
    float torque = 0.1f;     ///< [N m], likewise
    float drag = 2.0f;       ///< [N s/m], of a rod that slips
};

struct RodSettings {
    int segments = 16;               ///< cost grows linearly; the tip's error falls with the square
    float density = 1300.0f;         ///< [kg/m^3], plasticised PVC (1200-1350)
    float connector_mass = 1.5e-3f;  ///< [kg], carried by the rearmost segment
    float poisson_ratio = 0.45f;     ///< twist stiffness is E I / (1 + ratio)
    float retardation_time = 2e-3f;  ///< [s], bending viscosity over stiffness; a loss factor of 0.1 at 8 Hz
    float velocity_damping = 1.0f;   ///< [1/s], rate at which free motion decays; 0 conserves momentum
    float max_speed = 10.0f;         ///< [m/s], per segment; ten times the fastest hand
    bool held = true;                ///< false: nothing holds the rod, and the grip only lays it out
    std::optional<RodHold> hold;     ///< none: what is held goes where the grip goes, whatever it meets
};

/// What the rod exerts on the hand that holds it.
struct GripWrench {
    Vec3f force = Vec3f::Zero();   ///< [N]
    Vec3f torque = Vec3f::Zero();  ///< [N m], about the grip point
};

/// The tube as a Cosserat rod: rigid segments with stretch, shear, bending and twist compliances from
/// the section. A pass takes one Newton step of the implicit Euler equations in their compliant form
/// (XPBD's multipliers), all joints at once by a block-tridiagonal Cholesky (Deul, Kugelstadt, Weiler
/// & Bender 2018), so that stiffness needs no iterations. Unlike XPBD, a pass measures inertia from
/// where loads alone would send each segment, however far that is; joints are only ever linearised
/// about where the segments are. One segment is held: its origin is the grip, or is drawn there by a hold. A
/// segment's inertia is its transverse one about every axis: a slim segment's axial inertia would only make
/// twist ring faster than the substep. Doubles throughout.
///
/// A substep: predict, then passes of solve() with the contacts found before each, then finish. With
/// contacts it takes two passes: the first finds which of them hold, the second with what force. push() and
/// displace() are for obstacles that have to be met one at a time; the next solve() closes what they tore
/// open. Nothing allocates after construction.
class Rod {
  public:
    Rod(const Tube& tube, const RodSettings& settings, const RigidTransform& grip);

    /// At rest on its manufactured curve.
    void reset(const RigidTransform& grip);

    /// Takes another modulus and another curve from `tube`; sizes and masses stay as they were built.
    void set_material(const Tube& tube);

    /// Moves all segments by their velocities for `dt` [s], the held one to `grip`. Gravity waits for
    /// solve(): where forces balance, velocity alone is the better guess.
    void predict(float dt, const Vec3f& gravity, const RigidTransform& grip);

    /// Loads a point of a segment with a constant force [N] during this substep; takes effect in the
    /// next solve().
    void load(std::size_t segment, float along, const Vec3f& force);

    /// One Newton step of the whole chain and its contacts, whose gaps, normals and slips are to be those
    /// of the present pose, and whose forces it updates. Contacts with a segment held without a hold get the
    /// force that their overlap asks for, and the hand does not give way. Where `room` [m] is given, one a
    /// segment, no point of a segment goes further than that: the whole step is shortened.
    void solve(std::span<RodContact> contacts = {}, std::span<const float> room = {});

    /// Shortens the way that predict() took, so that no point of a segment has gone further than `room` [m].
    void hold_back(std::span<const float> room);

    /// New velocities from the way travelled since predict.
    void finish();

    [[nodiscard]] std::size_t size() const { return segments_.size(); }
    [[nodiscard]] std::size_t held() const { return held_; }
    [[nodiscard]] std::span<const RodSegment> segments() const { return segments_; }
    [[nodiscard]] float length(std::size_t segment) const;  ///< [m]
    [[nodiscard]] float radius() const { return radius_; }  ///< [m], outer

    /// A segment's pose now, and setting it, at rest; for starts from other shapes than the manufactured one.
    [[nodiscard]] RigidTransform pose(std::size_t segment) const;
    void place(std::size_t segment, const RigidTransform& pose);

    /// A point on a segment's centre line, `along` from 0 (rear) to 1 (front) [m]; where it is now and
    /// where it was at predict.
    [[nodiscard]] Vec3f point(std::size_t segment, float along) const;
    [[nodiscard]] Vec3f previous_point(std::size_t segment, float along) const;

    /// size() + 1 points of the centre line from connector to tip [m].
    void nodes(std::span<Vec3f> out) const;
    [[nodiscard]] Vec3f tip() const { return point(size() - 1, 1.0f); }

    /// Inverse mass [1/kg] that a free segment, without its neighbours, shows at a point offset from
    /// its centre line by `offset` [m], along the unit `direction` (Mueller et al. 2020, eq. 2). 0 for
    /// the held one.
    [[nodiscard]] float inverse_mass(std::size_t segment, float along, const Vec3f& offset,
                                     const Vec3f& direction) const;

    /// Gives a segment the positional impulse `impulse` [kg m] at a point (Mueller et al. 2020, eq. 6-9).
    /// The segment moves at once, as if it were alone; the next solve() spreads the impulse along the chain.
    void push(std::size_t segment, float along, const Vec3f& offset, const Vec3f& impulse);

    /// Moves a point of a segment by `displacement` [m]; returns the positional impulse [kg m] that took.
    /// Over dt^2 that is a force [N].
    Vec3f displace(std::size_t segment, float along, const Vec3f& offset, const Vec3f& displacement);

    /// What the hold draws with; without one, from the joints' multipliers of this substep and the held
    /// segment's weight, without its inertia.
    [[nodiscard]] GripWrench grip_wrench() const;

    /// Kinetic plus elastic plus gravitational energy [J] of the free segments (height against the last
    /// gravity; arbitrary origin).
    [[nodiscard]] double energy() const;

  private:
    /// Where velocity and impulses alone would take a segment in this substep.
    struct Target {
        Vec3d position = Vec3d::Zero();
        Quatd rotation = Quatd::Identity();
    };
    /// How a segment answers an impulse: by its inverse mass and inertia, or, where it has contacts, by
    /// a full matrix.
    struct Response {
        bool touched = false;
        RodContactSystem contacts;
        Mat6d inverse = Mat6d::Zero();
    };

    /// Force and torque on the held segment.
    struct Held {
        Vec3d force = Vec3d::Zero();   ///< [N]
        Vec3d torque = Vec3d::Zero();  ///< [N m]
        Mat3d stiffness = Mat3d::Zero();
        Mat3d turning = Mat3d::Zero();
    };

    [[nodiscard]] Held held_by_hold() const;
    void lay_out(const Tube& tube, const RodSettings& settings);
    void assemble();
    void add_contacts(std::span<RodContact> contacts);
    void add_hold();
    [[nodiscard]] Response& touch(std::size_t segment);
    [[nodiscard]] double grip_stiffness(std::size_t segment) const;
    [[nodiscard]] Vec6d answer(std::size_t segment, const Vec6d& impulse) const;
    [[nodiscard]] Vec3d arm(std::size_t segment, float along, const Vec3f& offset) const;

    std::vector<RodSegment> segments_;
    std::vector<RodSegment> previous_;  ///< poses at predict
    std::vector<RodJoint> joints_;
    std::vector<RodJointState> state_;
    std::vector<Vec3d> angle_before_;  ///< [rad], joints' angles at predict
    std::vector<Target> target_;
    std::vector<Vec6d> multiplier_;  ///< [N s^2, N m s^2], one per joint
    std::vector<Vec6d> motion_;      ///< [m, rad], displacement and rotation of segments in this pass
    std::vector<Response> response_;
    RodChain chain_;
    std::size_t held_ = 0;
    float radius_ = 0.0f;
    double held_mass_ = 0.0;  ///< [kg]; 0 when nothing holds the rod, or a hold does
    std::optional<RodHold> hold_;
    Target grip_;  ///< where the hold draws the held segment
    double dt_ = 1e-3;
    double retardation_time_ = 0.0;
    double velocity_damping_ = 0.0;
    double poisson_ratio_ = 0.0;
    double max_speed_ = 0.0;
    Vec3d gravity_ = Vec3d::Zero();
};

}  // namespace eti::pbd
