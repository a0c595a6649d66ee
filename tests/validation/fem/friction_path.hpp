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

/// A rigid body that does not move, as its distance.
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

/// A body whose skin is made of balls about its vertices and about the quarter points of its edges, which
/// make sausages of these but for a few hundredths of a millimetre; pressed by a rigid tool that moves, and
/// by a solid that does not, with Coulomb friction on both.
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
    std::vector<std::uint32_t> points;                ///< vertices that meet the tool
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< of the mesh, that meet the tool
    std::vector<std::uint32_t> on_solid;              ///< vertices that meet the solid, by their centres
    std::vector<Capsule> tool;
    const Solid* solid = nullptr;
    double tool_friction = 0.0, solid_friction = 0.0;
    std::vector<double> drag;  ///< [N s/m] on each vertex, against motion in space; none where empty
};

struct PathSettings {
    double stiffness = 2e3;   ///< [N/m] of every contact, across
    double sticking = 1e3;    ///< [N/m], along, while it sticks
    bool multipliers = true;  ///< without, contacts are springs of that stiffness
    /// [N/m]; above zero contacts with the solid are springs of it. Between a tool and a solid that both do
    /// not yield there may be no room for a body.
    double solid_spring = 0.0;
    double penetration = 0.02e-3;  ///< [m], bound for the deepest contact, which multipliers see to
    double friction = 2e-3;  ///< bound for the change of friction from round to round, in parts of all force
    double residual = 1e-6;  ///< bound for the largest unbalanced force, in parts of the largest force
    int rounds = 40;         ///< most of them, of multipliers and friction
};

/// What one increment came to.
struct Increment {
    bool converged = false;
    int rounds = 0;
    int iterations = 0;        ///< of Newton's method
    double residual = 0.0;     ///< largest unbalanced force, in parts of the largest force
    double penetration = 0.0;  ///< [m], of the deepest contact that has a multiplier
    double changed = 0.0;      ///< what the last round changed of friction, in parts of all force
};

/// Quasi-static equilibria along a tool's way, one from the last: friction asks where things came from.
///
/// Each contact presses with max(0, multiplier - stiffness gap), multipliers being updated until nothing
/// penetrates (Hestenes 1969, Powell 1969), and is held back along by a spring from where it stuck, which
/// yields at Coulomb's limit: return mapping, once per increment (Wriggers 2006, Computational Contact
/// Mechanics, 2nd ed., sec. 10.5). In a round the limit, and with it the plane of sliding, stays what
/// the last round left, so that each round has an energy to minimise, by Newton's method with line search;
/// rounds go on until friction does not change.
///
/// Where bodies are pressed hard, equilibria end and the body snaps to others far off. step() follows it
/// there in time: each is one of implicit Euler of the body slowed down by its drag, whose minimum exists and
/// is near. Steps of growing length with a tool that stands still lead to an equilibrium (Kelley & Keyes
/// 1998, SIAM J Numer Anal 35:508), in which drag has no part.
class FrictionPath {
  public:
    FrictionPath(PathProblem problem, const PathSettings& settings);

    /// The next equilibrium, with the tool at `tool` and held coordinates displaced as `displacement` [m]
    /// tells, in the order of body.held; as before if empty.
    Increment advance(const Eigen::Isometry3d& tool, std::span<const double> displacement = {});

    /// A step of `duration` [s] in time, to a residual below `bound`: one round, that takes multipliers and
    /// friction's limits from the step before. Where steps change nothing any more, nothing lags.
    Increment step(const Eigen::Isometry3d& tool, std::span<const double> displacement, double duration,
                   double bound);

    [[nodiscard]] const Eigen::VectorXd& position() const { return x_; }  ///< x0 y0 z0 x1 ... [m]
    /// [N], of the tool on each vertex, in the last increment.
    [[nodiscard]] std::vector<Vec3d> tool_force() const { return contact_force(true); }
    /// [N], of the solid on each vertex.
    [[nodiscard]] std::vector<Vec3d> solid_force() const { return contact_force(false); }
    /// [N], of mesh and springs at any coordinates: what holds the vertices where they are.
    [[nodiscard]] Eigen::VectorXd internal_force(const Eigen::VectorXd& x) const;

    /// What a round minimises, and its derivatives, for tests. Of contacts only what is within reach counts.
    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;
    [[nodiscard]] const Eigen::SparseMatrix<double>& hessian(const Eigen::VectorXd& x, bool definite);

  private:
    static constexpr std::uint32_t the_solid = ~0u;
    struct Contact {
        std::uint32_t a = 0, b = 0;  ///< vertices; the same for a ball about one
        double share = 0.0;          ///< of b in its place
        std::uint32_t target = 0;    ///< capsule, or the solid
        double reach = 0.0;          ///< [m], of both
        double multiplier = 0.0;     ///< [N]
        double force = 0.0;          ///< [N], across, as the last round left it
        Vec3d all = Vec3d::Zero();   ///< [N], on the body, with friction, as the last increment left it
        // What this round takes for given.
        double limit = 0.0;             ///< [N], of friction
        Vec3d normal = Vec3d::UnitZ();  ///< unit
        // What the increment began with.
        Vec3d stretch = Vec3d::Zero();  ///< [m], of the spring along
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
    /// How far the spring along is stretched [m].
    [[nodiscard]] Vec3d slip_of(const Contact& contact, const Eigen::VectorXd& x) const;
    [[nodiscard]] Vec3d friction_force(const Contact& contact, const Eigen::VectorXd& x) const;
    void begin(const Eigen::Isometry3d& tool, std::span<const double> displacement);
    /// Limits of friction, their directions and places, from where things are and press now.
    void fix_friction();
    /// Takes over what presses now; tells what this changes.
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
    /// Newton's method on this round's energy, to a residual below the bound; whether it got there.
    bool minimise(Increment& out, double bound);

    PathProblem problem_;
    PathSettings settings_;
    Potential potential_;
    std::vector<bool> held_;  // by coordinate
    BlockMatrix matrix_;
    std::vector<Contact> contacts_;
    std::vector<std::uint32_t> near_;         // contacts that can meet in this increment
    std::vector<PathProblem::Capsule> tool_;  // where it is now
    Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
    bool begun_ = false;
    Eigen::VectorXd x_;
    Eigen::VectorXd carried_;  // where the tool would have carried each vertex in this increment
    Eigen::VectorXd before_;   // where each was before
    double duration_ = 0.0;    // [s], of this step; 0: equilibrium
};

}  // namespace eti::fem
