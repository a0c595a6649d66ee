// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/friction_path.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace eti::fem {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::VectorXd;

constexpr double within_reach = 5e-3;      // [m], more than anything moves in an increment
constexpr int path_iteration_limit = 200;  // per round
constexpr double far_off = 0.3;            // residual
constexpr double first_bound = 1e-2;       // of the residual, in the first round

Vec3d at(const VectorXd& x, std::uint32_t vertex) {
    return x.segment<3>(3 * static_cast<Index>(vertex));
}

std::vector<bool> held_coordinates(const Problem& body) {
    std::vector<bool> held(3 * body.rest.size(), false);
    for (const Problem::Held& h : body.held) {
        held[3 * h.vertex + static_cast<std::uint32_t>(h.axis)] = true;
    }
    return held;
}

std::vector<std::array<std::uint32_t, 2>> joined(const PathProblem& problem) {
    std::vector<std::array<std::uint32_t, 2>> pairs = problem.edges;
    for (const auto& corner : problem.body.tetrahedra) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                pairs.push_back({corner[i], corner[j]});
            }
        }
    }
    for (const PathProblem::Spring& spring : problem.springs) {
        pairs.push_back({spring.a, spring.b});
    }
    return pairs;
}

}  // namespace

FrictionPath::FrictionPath(PathProblem problem, const PathSettings& settings)
    : problem_(std::move(problem)),
      settings_(settings),
      potential_(problem_.body),
      held_(held_coordinates(problem_.body)),
      matrix_(problem_.body.rest.size(), joined(problem_), held_) {
    assert(problem_.body.obstacles.empty());
    const std::size_t vertices = problem_.body.rest.size();
    problem_.radius.resize(vertices, 0.0);
    x_.resize(3 * static_cast<Index>(vertices));
    for (std::size_t i = 0; i < vertices; ++i) {
        x_.segment<3>(3 * static_cast<Index>(i)) = problem_.body.rest[i];
    }
    for (std::uint32_t c = 0; c < problem_.tool.size(); ++c) {
        const double thick = problem_.tool[c].radius;
        for (const std::uint32_t i : problem_.points) {
            contacts_.push_back({.a = i, .b = i, .target = c, .reach = thick + problem_.radius[i]});
        }
        for (const auto& [a, b] : problem_.edges) {
            for (const double share : {0.25, 0.5, 0.75}) {
                contacts_.push_back(
                    {.a = a,
                     .b = b,
                     .share = share,
                     .target = c,
                     .reach = thick + (1.0 - share) * problem_.radius[a] + share * problem_.radius[b]});
            }
        }
    }
    if (problem_.solid != nullptr) {
        for (const std::uint32_t i : problem_.on_solid) {
            contacts_.push_back({.a = i, .b = i, .target = the_solid});
        }
    }
    carried_ = before_ = x_;
}

Vec3d FrictionPath::place_of(const Contact& contact, const VectorXd& x) {
    return (1.0 - contact.share) * at(x, contact.a) + contact.share * at(x, contact.b);
}

Solid::Sample FrictionPath::gap_of(const Contact& contact, const VectorXd& x) const {
    const Vec3d place = place_of(contact, x);
    if (contact.target == the_solid) {
        return problem_.solid->sample(place);
    }
    const PathProblem::Capsule& capsule = tool_[contact.target];
    const Vec3d axis = capsule.b - capsule.a;
    const double t = (place - capsule.a).dot(axis) / axis.squaredNorm();
    const Vec3d apart = place - capsule.a - std::clamp(t, 0.0, 1.0) * axis;
    const double distance = std::max(apart.norm(), 1e-12);
    const Vec3d out = apart / distance;
    Matrix3d bend = Matrix3d::Identity() - out * out.transpose();
    if (t > 0.0 && t < 1.0) {
        bend -= axis * axis.transpose() / axis.squaredNorm();
    }
    return {distance - contact.reach, out, bend / distance};
}

double FrictionPath::pressed(const Contact& contact, double gap) const {
    return std::max(0.0, contact.multiplier - stiffness_of(contact) * gap);
}

Vec3d FrictionPath::slip_of(const Contact& contact, const VectorXd& x) const {
    const Vec3d way = contact.stretch + place_of(contact, x) -
                      place_of(contact, contact.target == the_solid ? before_ : carried_);
    return way - way.dot(contact.normal) * contact.normal;
}

Vec3d FrictionPath::friction_force(const Contact& contact, const VectorXd& x) const {
    const Vec3d slip = slip_of(contact, x);
    const double length = slip.norm();
    const bool slides = settings_.sticking * length > contact.limit;
    return -(slides ? contact.limit / length : settings_.sticking) * slip;
}

double FrictionPath::energy(const VectorXd& x) const {
    double sum = potential_.energy(x);
    for (const PathProblem::Spring& spring : problem_.springs) {
        const double stretch = (at(x, spring.b) - at(x, spring.a)).norm() - spring.length;
        sum += 0.5 * spring.stiffness * stretch * stretch;
    }
    if (duration_ > 0.0) {
        for (std::uint32_t i = 0; i < problem_.drag.size(); ++i) {
            sum += 0.5 * problem_.drag[i] / duration_ * (at(x, i) - at(before_, i)).squaredNorm();
        }
    }
    const double k = settings_.sticking;
    for (const std::uint32_t n : near_) {
        const Contact& c = contacts_[n];
        const double p = pressed(c, gap_of(c, x).distance);
        sum += 0.5 * p * p / stiffness_of(c);
        if (c.limit > 0.0) {
            const double slip = slip_of(c, x).norm();
            sum += k * slip > c.limit ? c.limit * (slip - 0.5 * c.limit / k) : 0.5 * k * slip * slip;
        }
    }
    return sum;
}

VectorXd FrictionPath::internal_force(const VectorXd& x) const {
    VectorXd out = potential_.gradient(x);
    for (const PathProblem::Spring& spring : problem_.springs) {
        const Vec3d apart = at(x, spring.b) - at(x, spring.a);
        const double length = apart.norm();
        const Vec3d pull = spring.stiffness * (1.0 - spring.length / length) * apart;
        out.segment<3>(3 * static_cast<Index>(spring.a)) -= pull;
        out.segment<3>(3 * static_cast<Index>(spring.b)) += pull;
    }
    return out;
}

VectorXd FrictionPath::gradient(const VectorXd& x) const {
    VectorXd out = internal_force(x);
    if (duration_ > 0.0) {
        for (std::uint32_t i = 0; i < problem_.drag.size(); ++i) {
            out.segment<3>(3 * static_cast<Index>(i)) +=
                problem_.drag[i] / duration_ * (at(x, i) - at(before_, i));
        }
    }
    for (const std::uint32_t n : near_) {
        const Contact& c = contacts_[n];
        const Solid::Sample gap = gap_of(c, x);
        Vec3d force = pressed(c, gap.distance) * gap.slope;
        if (c.limit > 0.0) {
            force += friction_force(c, x);
        }
        out.segment<3>(3 * static_cast<Index>(c.a)) -= (1.0 - c.share) * force;
        out.segment<3>(3 * static_cast<Index>(c.b)) -= c.share * force;
    }
    return out;
}

const Eigen::SparseMatrix<double>& FrictionPath::hessian(const VectorXd& x, bool definite) {
    matrix_.set_zero();
    for (std::size_t e = 0; e < potential_.elements(); ++e) {
        const auto& corner = potential_.corners(e);
        const Eigen::Matrix<double, 12, 12> k = potential_.stiffness(e, x, definite);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                matrix_.add(corner[i], corner[j],
                            k.block<3, 3>(3 * static_cast<Index>(i), 3 * static_cast<Index>(j)));
            }
        }
    }
    if (duration_ > 0.0) {
        for (std::uint32_t i = 0; i < problem_.drag.size(); ++i) {
            matrix_.add(i, i, problem_.drag[i] / duration_ * Matrix3d::Identity());
        }
    }
    for (const PathProblem::Spring& spring : problem_.springs) {
        const Vec3d apart = at(x, spring.b) - at(x, spring.a);
        const double length = apart.norm();
        const Matrix3d along = apart * apart.transpose() / (length * length);
        const double across = 1.0 - spring.length / length;
        const Matrix3d k = spring.stiffness * (along + (definite ? std::max(0.0, across) : across) *
                                                           (Matrix3d::Identity() - along));
        matrix_.add(spring.a, spring.a, k);
        matrix_.add(spring.b, spring.b, k);
        matrix_.add(spring.a, spring.b, -k);
        matrix_.add(spring.b, spring.a, -k);
    }
    for (const std::uint32_t n : near_) {
        const Contact& c = contacts_[n];
        const Solid::Sample gap = gap_of(c, x);
        const double p = pressed(c, gap.distance);
        Matrix3d k = Matrix3d::Zero();
        if (p > 0.0) {
            k = stiffness_of(c) * gap.slope * gap.slope.transpose();
            if (!definite) {
                k -= p * gap.bend;
            }
        }
        if (c.limit > 0.0) {
            const Vec3d slip = slip_of(c, x);
            const double length = slip.norm();
            const Matrix3d across = Matrix3d::Identity() - c.normal * c.normal.transpose();
            k += settings_.sticking * length > c.limit
                     ? Matrix3d(c.limit / length * (across - slip * slip.transpose() / (length * length)))
                     : Matrix3d(settings_.sticking * across);
        }
        if (p > 0.0 || c.limit > 0.0) {
            const double a = 1.0 - c.share;
            matrix_.add(c.a, c.a, a * a * k);
            if (c.share > 0.0) {
                matrix_.add(c.a, c.b, a * c.share * k);
                matrix_.add(c.b, c.a, a * c.share * k);
                matrix_.add(c.b, c.b, c.share * c.share * k);
            }
        }
    }
    return matrix_.matrix();
}

bool FrictionPath::minimise(Increment& out, double bound) {
    const auto still = [&](VectorXd v) {
        for (std::size_t i = 0; i < held_.size(); ++i) {
            if (held_[i]) {
                v[static_cast<Index>(i)] = 0.0;
            }
        }
        return v;
    };
    for (int k = 0; k < path_iteration_limit; ++k, ++out.iterations) {
        const VectorXd residual = still(gradient(x_));
        double largest = potential_.largest_element_force(x_);
        for (const std::uint32_t n : near_) {
            largest = std::max(largest, contacts_[n].force);
        }
        out.residual = residual.cwiseAbs().maxCoeff() / largest;
        if (out.residual < bound) {
            return true;
        }
        const auto factorised = [&](bool definite) {
            (void)hessian(x_, definite);
            matrix_.hold();
            return matrix_.factorise();
        };
        // Far from the solution the exact Hessian is seldom definite, and of little use.
        if ((out.residual > far_off || !factorised(false)) && !factorised(true)) {
            return false;
        }
        const VectorXd step = matrix_.solve(-residual);
        const double slope = residual.dot(step);
        const double energy_here = energy(x_);
        double length = 1.0;
        for (; length > 1e-10; length *= 0.5) {
            const VectorXd tried = x_ + length * step;
            // Armijo's rule, down to the rounding of the energy; below that the residual decides.
            if (energy(tried) <= energy_here + 1e-4 * length * slope + 1e-13 * std::fabs(energy_here)) {
                x_ = tried;
                break;
            }
        }
        if (length <= 1e-10) {
            return false;
        }
    }
    return false;
}

void FrictionPath::begin(const Eigen::Isometry3d& tool, std::span<const double> displacement) {
    const Eigen::Isometry3d moved = begun_ ? tool * pose_.inverse() : Eigen::Isometry3d::Identity();
    pose_ = tool;
    tool_.clear();
    for (const PathProblem::Capsule& c : problem_.tool) {
        tool_.push_back({tool * c.a, tool * c.b, c.radius});
    }
    before_ = x_;
    for (Index i = 0; i < x_.size(); i += 3) {
        carried_.segment<3>(i) = moved * Vec3d(x_.segment<3>(i));
    }
    for (Contact& c : contacts_) {
        if (c.target != the_solid) {
            c.stretch = moved.linear() * c.stretch;
        }
    }
    assert(displacement.empty() || displacement.size() == problem_.body.held.size());
    for (std::size_t n = 0; n < problem_.body.held.size(); ++n) {
        Problem::Held& h = problem_.body.held[n];
        if (!displacement.empty()) {
            h.displacement = displacement[n];
        }
        x_[3 * static_cast<Index>(h.vertex) + h.axis] = problem_.body.rest[h.vertex][h.axis] + h.displacement;
    }
}

void FrictionPath::find_near(const VectorXd& x) {
    near_.clear();
    for (std::uint32_t n = 0; n < contacts_.size(); ++n) {
        if (contacts_[n].force > 0.0 || gap_of(contacts_[n], x).distance < within_reach) {
            near_.push_back(n);
        }
    }
}

void FrictionPath::fix_friction() {
    for (const std::uint32_t n : near_) {
        Contact& c = contacts_[n];
        c.limit = friction_of(c) * c.force;
        c.normal = gap_of(c, x_).slope.normalized();
    }
}

void FrictionPath::update(Increment& out) {
    out.penetration = 0.0;
    double all = 0.0;
    double apart = 0.0;
    for (const std::uint32_t n : near_) {
        Contact& c = contacts_[n];
        const Solid::Sample gap = gap_of(c, x_);
        const double p = pressed(c, gap.distance);
        if (p > 0.0 && !is_spring(c)) {
            // A multiplier on an open contact is an error like penetration.
            out.penetration = std::max(out.penetration, std::fabs(gap.distance));
        }
        Contact next = c;
        next.force = p;
        next.multiplier = settings_.multipliers && !is_spring(c) ? p : 0.0;
        next.limit = friction_of(c) * p;
        next.normal = gap.slope.normalized();
        all += p;
        apart += (friction_force(next, x_) - friction_force(c, x_)).norm();
        c.force = next.force;
        c.multiplier = next.multiplier;
    }
    out.changed = all > 0.0 ? apart / all : 0.0;
}

void FrictionPath::end() {
    for (Contact& c : contacts_) {
        c.all.setZero();
        if (c.force <= 0.0) {
            c.stretch.setZero();
            c.limit = 0.0;
        }
    }
    for (const std::uint32_t n : near_) {
        Contact& c = contacts_[n];
        if (c.force <= 0.0) {
            continue;
        }
        const Vec3d along = friction_force(c, x_);
        c.all = c.force * gap_of(c, x_).slope + along;
        c.stretch = -along / settings_.sticking;
    }
}

void FrictionPath::restore(State state) {
    x_ = std::move(state.x);
    contacts_ = std::move(state.contacts);
    pose_ = state.pose;
    problem_.body.held = std::move(state.held);
}

Increment FrictionPath::advance(const Eigen::Isometry3d& tool, std::span<const double> displacement) {
    State before = state();
    begin(tool, displacement);
    Increment out;
    double bound = std::max(settings_.residual, first_bound);
    for (out.rounds = 1; out.rounds <= settings_.rounds; ++out.rounds) {
        find_near(x_);
        fix_friction();
        if (!minimise(out, bound)) {
            break;
        }
        find_near(x_);
        update(out);
        const bool settled = out.changed < settings_.friction &&
                             (!settings_.multipliers || out.penetration < settings_.penetration);
        if (settled && bound <= settings_.residual) {
            out.converged = true;
            break;
        }
        bound = settled ? settings_.residual : std::max(settings_.residual, 0.1 * bound);
    }
    if (out.converged) {
        end();
        begun_ = true;
    } else {
        restore(std::move(before));
    }
    return out;
}

Increment FrictionPath::step(const Eigen::Isometry3d& tool, std::span<const double> displacement,
                             double duration, double bound) {
    State before = state();
    begin(tool, displacement);
    Increment out;
    out.rounds = 1;
    find_near(x_);
    fix_friction();
    duration_ = duration;
    out.converged = minimise(out, bound);
    duration_ = 0.0;
    if (out.converged) {
        find_near(x_);
        update(out);
        end();
        begun_ = true;
    } else {
        restore(std::move(before));
    }
    return out;
}

std::vector<Vec3d> FrictionPath::contact_force(bool of_tool) const {
    std::vector<Vec3d> out(problem_.body.rest.size(), Vec3d::Zero());
    for (const Contact& c : contacts_) {
        if ((c.target != the_solid) == of_tool) {
            out[c.a] += (1.0 - c.share) * c.all;
            out[c.b] += c.share * c.all;
        }
    }
    return out;
}

}  // namespace eti::fem
