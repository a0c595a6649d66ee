// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "server/pbd/rod/rod_chain.hpp"
#include "server/pbd/rod/rod_contact.hpp"
#include "server/pbd/rod/rod_joint.hpp"

namespace eti::pbd {

/// How fingers hold a rod: a compliant spring. Beyond `force` or `torque` the rod slips.
struct RodHold {
    float stiffness = 5e3f;             ///< [N/m]
    float rotational_stiffness = 2.0f;  ///< [N m/rad]
    float force = 5.0f;                 ///< [N], maximum
    float torque = 0.1f;                ///< [N m], maximum
    float drag = 2.0f;                  ///< [N s/m], while the rod slips
};

struct RodSettings {
    int segments = 16;               ///< cost grows linearly; the tip's error decreases quadratically
    float density = 1300.0f;         ///< [kg/m^3], plasticised PVC (1200-1350)
    float connector_mass = 1.5e-3f;  ///< [kg], added to the rearmost segment
    float poisson_ratio = 0.45f;     ///< twist stiffness is E I / (1 + ratio)
    float retardation_time = 2e-3f;  ///< [s], bending viscosity over stiffness; a loss factor of 0.1 at 8 Hz
    float velocity_damping = 1.0f;   ///< [1/s], decay rate of free motion; 0 conserves momentum
    float max_speed = 10.0f;         ///< [m/s], per segment; ten times the fastest hand
    bool held = true;                ///< false: a free rod; the grip only sets its initial pose
    std::optional<RodHold> hold;     ///< none: the held segment follows the grip exactly, whatever the
                                     ///< contact forces
};

/// Wrench of the rod on the hand.
struct GripWrench {
    Vec3f force = Vec3f::Zero();   ///< [N]
    Vec3f torque = Vec3f::Zero();  ///< [N m], about the grip point
};

/// The tube as a Cosserat rod: rigid segments with stretch, shear, bending and twist compliances from the
/// cross-section.
///
/// A pass takes one Newton step of the implicit Euler equations in compliant form (XPBD's multipliers), for
/// all joints at once by a block-tridiagonal Cholesky factorization (Deul, Kugelstadt, Weiler & Bender 2018),
/// so that stiffness needs no iterations. Unlike XPBD, a pass measures inertia from where loads alone would
/// move each segment; joints are always linearised at the segments' current poses.
///
/// One segment is held: its origin is the grip, or is pulled to it by a RodHold. A segment's inertia is its
/// transverse one about every axis: a slim segment's axial inertia would only add twist oscillations faster
/// than the substep. Double precision throughout.
///
/// A substep is: predict(), then passes of solve() with the contacts found before each, then finish(). With
/// contacts two passes are needed: the first finds which contacts are active, the second their forces. No
/// allocation after construction.
class Rod {
  public:
    Rod(const Tube& tube, const RodSettings& settings, const RigidTransform& grip);

    /// Resets to the manufactured curve, at rest.
    void reset(const RigidTransform& grip);

    /// Sets Young's modulus and curve from `tube`; sizes and masses remain as built.
    void set_material(const Tube& tube);

    /// Moves all segments by their velocities for `dt` [s], and the held one to `grip`. Gravity is applied in
    /// solve(): where forces balance, velocity alone is the better initial guess.
    void predict(float dt, const Vec3f& gravity, const RigidTransform& grip);

    /// Applies a constant force [N] to a point of a segment during this substep; takes effect in the next
    /// solve().
    void load(std::size_t segment, float along, const Vec3f& force);

    /// One Newton step of the chain and its contacts. Gaps, normals and slips of the contacts must be those
    /// of the current pose; their forces are updated. Contacts with a segment held without a RodHold get the
    /// penalty force of their overlap, and the hand does not move. `clearance` [segments][m], where given,
    /// limits the displacement of every point of a segment: the whole step is shortened.
    void solve(std::span<RodContact> contacts = {}, std::span<const float> clearance = {});

    /// Shortens the displacement of predict() so that no point of a segment has moved farther than
    /// `clearance` [m].
    void limit_motion(std::span<const float> clearance);

    /// Computes velocities from the displacements since predict().
    void finish();

    [[nodiscard]] std::size_t size() const { return segments_.size(); }
    [[nodiscard]] std::size_t held() const { return held_; }
    [[nodiscard]] std::span<const RodSegment> segments() const { return segments_; }
    [[nodiscard]] float length(std::size_t segment) const;  ///< [m]
    [[nodiscard]] float radius() const { return radius_; }  ///< [m], outer

    /// Gets a segment's pose, or sets it at rest, to start from another shape than the manufactured one.
    [[nodiscard]] RigidTransform pose(std::size_t segment) const;
    void place(std::size_t segment, const RigidTransform& pose);

    /// A point [m] on a segment's centre line, `along` from 0 (rear) to 1 (front): current, and as of
    /// predict().
    [[nodiscard]] Vec3f point(std::size_t segment, float along) const;
    [[nodiscard]] Vec3f previous_point(std::size_t segment, float along) const;

    /// size() + 1 points of the centre line from connector to tip [m].
    void nodes(std::span<Vec3f> out) const;
    [[nodiscard]] Vec3f tip() const { return point(size() - 1, 1.0f); }

    /// Wrench of the hold. Without one: from the joints' multipliers of this substep and the held segment's
    /// weight, without its inertia.
    [[nodiscard]] GripWrench grip_wrench() const;

    /// Kinetic, elastic and gravitational energy [J] of the free segments (height along the last gravity;
    /// arbitrary origin).
    [[nodiscard]] double energy() const;

  private:
    /// Pose to which velocity and impulses alone would move a segment in this substep.
    struct Target {
        Vec3d position = Vec3d::Zero();
        Quatd rotation = Quatd::Identity();
    };
    /// Response of a segment to an impulse: from its inverse mass and inertia or, with contacts, a full
    /// matrix.
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
        Mat3d rotational_stiffness = Mat3d::Zero();
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

    std::vector<RodSegment> segments_;  ///< from rear to front
    std::vector<RodSegment> previous_;  ///< [segments], poses at predict()
    std::vector<RodJoint> joints_;      ///< [segments - 1]
    std::vector<RodJointState> state_;  ///< [joints]
    std::vector<Vec3d> angle_before_;   ///< [joints][rad], at predict()
    std::vector<Target> target_;        ///< [segments]
    std::vector<Vec6d> multiplier_;     ///< [joints][N s^2, N m s^2]
    std::vector<Vec6d> motion_;         ///< [segments][m, rad], displacement and rotation in this pass
    std::vector<Response> response_;    ///< [segments]
    RodChain chain_;
    std::size_t held_ = 0;
    float radius_ = 0.0f;
    double held_mass_ = 0.0;  ///< [kg]; 0 for a free rod or one with a RodHold
    std::optional<RodHold> hold_;
    Target grip_;  ///< target of the hold for the held segment
    double dt_ = 1e-3;
    double retardation_time_ = 0.0;
    double velocity_damping_ = 0.0;
    double poisson_ratio_ = 0.0;
    double max_speed_ = 0.0;
    Vec3d gravity_ = Vec3d::Zero();
};

}  // namespace eti::pbd
