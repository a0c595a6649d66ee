// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/validation/fem/block_matrix.hpp"
#include "tests/validation/fem/static_solver.hpp"

namespace eti::fem {

/// A rigid obstacle that does not move, given by its distance field.
class Solid {
  public:
    struct Sample {
        double distance = 0.0;                           ///< [m], negative inside
        Vec3d slope = Vec3d::UnitZ();                    ///< its gradient
        Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();  ///< its second derivative [1/m]
    };
    Solid() = default;
    Solid(const Solid&) = delete;
    Solid& operator=(const Solid&) = delete;
    virtual ~Solid() = default;
    [[nodiscard]] virtual Sample sample(const Vec3d& point) const = 0;
};

/// A body whose skin consists of balls about its vertices and about the quarter points of its edges
/// (sausages, but for a few hundredths of a millimetre). A moving rigid tool and a static solid press on it,
/// with Coulomb friction on both.
struct PathProblem {
    struct Capsule {
        Vec3d a = Vec3d::Zero(), b = Vec3d::Zero();  ///< [m], in the tool's frame
        double radius = 0.0;                         ///< [m]
    };
    struct Spring {
        std::uint32_t a = 0, b = 0;  ///< vertices
        double length = 0.0;         ///< [m], unloaded
        double stiffness = 0.0;      ///< [N/m]
    };
    Problem body;  ///< without obstacles
    std::vector<Spring> springs;
    std::vector<double> radius;                       ///< [m], of the ball about each vertex
    std::vector<std::uint32_t> points;                ///< vertices that may touch the tool
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< edges of the mesh that may touch the tool
    std::vector<std::uint32_t> on_solid;              ///< vertices whose centres may touch the solid
    std::vector<Capsule> tool;
    const Solid* solid = nullptr;
    double tool_friction = 0.0, solid_friction = 0.0;
    std::vector<double> drag;  ///< [N s/m] per vertex, against motion in space; none where empty
};

struct PathSettings {
    double stiffness = 2e3;   ///< [N/m] of every contact, normal
    double sticking = 1e3;    ///< [N/m], tangential, while it sticks
    bool multipliers = true;  ///< if false, contacts are penalty springs of that stiffness
    /// [N/m]; if positive, contacts with the solid are penalty springs of it. There may be no room for a body
    /// between a rigid tool and a rigid solid.
    double solid_spring = 0.0;
    double penetration = 0.02e-3;  ///< [m], bound for the deepest contact, enforced by the multipliers
    double friction = 2e-3;        ///< bound for the change of friction per round, relative to all forces
    double residual = 1e-6;        ///< bound for the largest unbalanced force, relative to the largest force
    int rounds = 40;               ///< at most, for multipliers and friction
};

/// Outcome of one increment.
struct Increment {
    bool converged = false;
    int rounds = 0;
    int iterations = 0;        ///< of Newton's method
    double residual = 0.0;     ///< largest unbalanced force, relative to the largest force
    double penetration = 0.0;  ///< [m], of the deepest contact with a multiplier
    double changed = 0.0;      ///< change of friction in the last round, relative to all forces
};

/// Quasi-static equilibria along a tool's path, each started from the last, because friction depends on the
/// path.
///
/// Each contact's normal force is max(0, multiplier - stiffness gap); multipliers are updated until nothing
/// penetrates (augmented Lagrangian: Hestenes 1969, Powell 1969). A tangential spring holds it where it stuck
/// and slips at Coulomb's limit: return mapping, once per increment (Wriggers 2006, Computational Contact
/// Mechanics, 2nd ed., sec. 10.5). Within a round the limit and the sliding plane are those of the previous
/// round, so that each round has an energy, which Newton's method with line search minimises. Rounds end when
/// friction no longer changes.
///
/// Under strong pressure a branch of equilibria may end, and the body snaps to a distant one. step() follows
/// this motion in time. Each step is one of implicit Euler of the body slowed down by its drag, whose minimum
/// exists and is near. Steps of growing length with a tool at rest lead to an equilibrium (Kelley & Keyes
/// 1998, SIAM J Numer Anal 35:508), in which drag has no part.
class FrictionPath {
  public:
    FrictionPath(PathProblem problem, const PathSettings& settings);

    /// Advances to the next equilibrium, with the tool at `tool` and the held coordinates displaced by
    /// `displacement` [m], in the order of body.held; unchanged if empty.
    Increment advance(const Eigen::Isometry3d& tool, std::span<const double> displacement = {});

    /// Advances `duration` [s] in time, to a residual below `bound`: one round, with multipliers and friction
    /// limits from the previous step. Once steps no longer change anything, this lag has no effect.
    Increment step(const Eigen::Isometry3d& tool, std::span<const double> displacement, double duration,
                   double bound);

    [[nodiscard]] const Eigen::VectorXd& position() const { return x_; }  ///< x0 y0 z0 x1 ... [m]
    /// [N], of the tool on each vertex, in the last increment.
    [[nodiscard]] std::vector<Vec3d> tool_force() const { return contact_force(true); }
    /// [N], of the solid on each vertex.
    [[nodiscard]] std::vector<Vec3d> solid_force() const { return contact_force(false); }
    /// [N], of mesh and springs at any coordinates: the force that holds the vertices in place.
    [[nodiscard]] Eigen::VectorXd internal_force(const Eigen::VectorXd& x) const;

    /// The energy that a round minimises, and its derivatives, for tests. Only contacts within reach count.
    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;
    [[nodiscard]] const Eigen::SparseMatrix<double>& hessian(const Eigen::VectorXd& x, bool definite);

  private:
    static constexpr std::uint32_t the_solid = ~0u;
    struct Contact {
        std::uint32_t a = 0, b = 0;  ///< vertices; equal for a ball about a single one
        double share = 0.0;          ///< barycentric weight of b
        std::uint32_t target = 0;    ///< index of the capsule, or the solid
        double reach = 0.0;          ///< [m], sum of both radii
        double multiplier = 0.0;     ///< [N]
        double force = 0.0;          ///< [N], normal, from the last round
        Vec3d all = Vec3d::Zero();   ///< [N], on the body, with friction, from the last increment
        // Held constant during a round.
        double limit = 0.0;             ///< [N], of friction
        Vec3d normal = Vec3d::UnitZ();  ///< unit
        // State at the start of the increment.
        Vec3d stretch = Vec3d::Zero();  ///< [m], of the tangential spring
    };
    [[nodiscard]] static Vec3d place_of(const Contact& contact, const Eigen::VectorXd& x);
    [[nodiscard]] Solid::Sample gap_of(const Contact& contact, const Eigen::VectorXd& x) const;
    [[nodiscard]] double pressed(const Contact& contact, double gap) const;
    [[nodiscard]] double stiffness_of(const Contact& contact) const {
        return is_spring(contact) ? settings_.solid_spring : settings_.stiffness;
    }
    [[nodiscard]] bool is_spring(const Contact& contact) const {
        return contact.target == the_solid && settings_.solid_spring > 0.0;
    }
    /// Stretch of the tangential spring [m].
    [[nodiscard]] Vec3d slip_of(const Contact& contact, const Eigen::VectorXd& x) const;
    [[nodiscard]] Vec3d friction_force(const Contact& contact, const Eigen::VectorXd& x) const;
    void begin(const Eigen::Isometry3d& tool, std::span<const double> displacement);
    /// Sets friction limits, directions and anchors from the current positions and normal forces.
    void fix_friction();
    /// Updates the multipliers from the current normal forces; reports the change.
    void update(Increment& out);
    void end();
    struct State {
        Eigen::VectorXd x;
        std::vector<Contact> contacts;
        Eigen::Isometry3d pose;
        std::vector<Problem::Held> held;
    };
    [[nodiscard]] State state() const { return {x_, contacts_, pose_, problem_.body.held}; }
    void restore(State state);
    [[nodiscard]] double friction_of(const Contact& contact) const {
        return contact.target == the_solid ? problem_.solid_friction : problem_.tool_friction;
    }
    [[nodiscard]] std::vector<Vec3d> contact_force(bool of_tool) const;
    void find_near(const Eigen::VectorXd& x);
    /// Newton's method on this round's energy, to a residual below the bound; returns whether it converged.
    bool minimise(Increment& out, double bound);

    PathProblem problem_;
    PathSettings settings_;
    Potential potential_;
    std::vector<bool> held_;  // by coordinate
    BlockMatrix matrix_;
    std::vector<Contact> contacts_;
    std::vector<std::uint32_t> near_;         // contacts that may close in this increment
    std::vector<PathProblem::Capsule> tool_;  // current pose
    Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
    bool begun_ = false;
    Eigen::VectorXd x_;
    Eigen::VectorXd carried_;  // where the tool would have carried each vertex in this increment
    Eigen::VectorXd before_;   // previous positions
    double duration_ = 0.0;    // [s], of this step; 0: equilibrium
};

}  // namespace eti::fem
