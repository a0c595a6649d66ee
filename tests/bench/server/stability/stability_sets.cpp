// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Clusters without volume, and constraints that cannot all be satisfied.
#include <functional>

#include "common/math/random.hpp"
#include "server/pbd/soft/links.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr double sets_watched = 3.0;  // [s]
constexpr double set_side = 10e-3;    // [m]
constexpr std::string_view set_figure = "sets";

/// Rest positions of a cluster's particles.
struct Shape {
    std::string name;
    std::vector<Vec3f> rest;
};

std::vector<Shape> shapes() {
    const auto s = static_cast<float>(set_side);
    Shape plane{"coplanar", {}}, line{"collinear", {}}, point{"coincident", {}};
    for (int k = 0; k < 25; ++k) {
        plane.rest.push_back(0.25f * s * Vec3f(static_cast<float>(k % 5), static_cast<float>(k / 5), 0.0f));
    }
    for (int k = 0; k < 5; ++k) {
        line.rest.push_back(0.25f * s * Vec3f(static_cast<float>(k), 0.0f, 0.0f));
        point.rest.emplace_back(0.3f * s, 0.2f * s, 0.1f * s);
    }
    return {plane, line, point, {"one particle", {Vec3f(0.3f * s, 0.2f * s, 0.1f * s)}}};
}

/// A free body of one cluster.
pbd::SoftBody body_of(const Shape& shape, Method method) {
    constexpr float mass = 4e3f * 8e-9f;
    pbd::SoftBody body;
    body.settings.damping = static_cast<float>(light_damping);
    const std::size_t count = shape.rest.size();
    body.particles.resize(count);
    body.particles.rest = shape.rest;
    body.particles.inverse_mass.assign(count, 1.0f / mass);
    pbd::ShapeMatching::Description description;
    description.first = {0, static_cast<std::uint32_t>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        description.member.push_back(static_cast<std::uint32_t>(i));
    }
    description.youngs_modulus = {static_cast<float>(BodySettings{}.youngs_modulus)};
    description.particle_volume.assign(count, 8e-9f);
    description.fitting_mass.assign(count, mass);
    description.goal_share = method == Method::shape_matching_pbd ? 0.3f : 0.0f;
    body.shapes.configure(description, body.particles);
    body.reset();
    return body;
}

/// Deviation of the distances between particles from those at rest [m]: a free body may rotate and drift.
double distortion(const pbd::Particles& p) {
    double worst = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const float change = (p.position[i] - p.position[j]).norm() - (p.rest[i] - p.rest[j]).norm();
            worst = std::isfinite(change) ? std::max(worst, std::fabs(static_cast<double>(change)))
                                          : std::numeric_limits<double>::infinity();
        }
        // A single particle must stay where it was put.
        if (p.size() == 1) {
            worst =
                static_cast<double>((p.position[0] - Vec3f::Constant(static_cast<float>(set_side))).norm());
        }
    }
    return worst;
}

struct Placement {
    std::string name;
    std::function<Vec3f(const Vec3f& rest, Random& random)> position;
};

RecoveryResult lone_cluster(const Shape& shape, const Placement& placement, Method method, double rate) {
    pbd::SoftBody body = body_of(shape, method);
    Random random(2);
    for (Vec3f& x : body.particles.position) {
        x = shape.rest.size() == 1 ? Vec3f(Vec3f::Constant(static_cast<float>(set_side)))
                                   : placement.position(x, random);
    }
    RecoveryTracker tracker(set_side, sets_watched);
    const double thrown = distortion(body.particles);
    const auto dt = static_cast<float>(1.0 / rate);
    for (int n = 1; n <= static_cast<int>(sets_watched * rate); ++n) {
        body.predict(dt, 1.0f);
        body.project(dt);
        body.finish(dt);
        tracker.observe(n / rate, distortion(body.particles), kinetic_energy(body.particles));
        tracker.observe(body.shapes.rotation()[0]);
    }
    return tracker.result(thrown);
}

/// A particle on two links of 10 and 20 mm to the same fixed point. It survives if it comes to rest between;
/// the residual is its distance from the balance of both forces.
RecoveryResult two_links(float stiffness_ratio, double rate) {
    const float stiffness[2] = {20.0f, 20.0f * stiffness_ratio};
    const float length[2] = {static_cast<float>(set_side), 2.0f * static_cast<float>(set_side)};
    const float balance =
        (stiffness[0] * length[0] + stiffness[1] * length[1]) / (stiffness[0] + stiffness[1]);
    const auto dt = static_cast<float>(1.0 / rate);
    const float keep = std::exp(-static_cast<float>(light_damping) * dt);
    constexpr float inverse_mass = 1.0f / (4e3f * 8e-9f);
    Vec3f anchor = Vec3f::Zero(), x(0.0f, 0.0f, 3.0f * length[0]), velocity = Vec3f::Zero();
    RecoveryTracker tracker(set_side, sets_watched);
    double off = 0.0;
    for (int n = 1; n <= static_cast<int>(sets_watched * rate); ++n) {
        const Vec3f before = x;
        x += dt * velocity;
        for (int k = 0; k < 2; ++k) {
            pbd::project_link(anchor, x, 0.0f, inverse_mass, length[k], stiffness[k], dt);
        }
        velocity = keep / dt * (x - before);
        const float distance = x.norm();
        off = static_cast<double>(std::fabs(distance - balance)) / set_side;
        const double outside =
            static_cast<double>(std::max({0.0f, length[0] - distance, distance - length[1]}));
        const double way = 1e-3 * static_cast<double>(velocity.norm());  // in the next millisecond
        tracker.observe(n / rate, outside + way,
                        0.5 * static_cast<double>(velocity.squaredNorm() / inverse_mass));
    }
    RecoveryResult course = tracker.result(2.0 * set_side);
    course.residual = off;
    return course;
}

/// The upper corners of a block, each held at rest by a cluster or tetrahedra, are linked to points one side
/// length away for half the time and then released.
RecoveryResult links_against_body(Method method, double rate, float stiffness) {
    const BodySettings setting = with_rate(method, rate);
    BlockBody body(10, 10, 10, setting);
    const std::array ways = {Vec3f(1, 0, 0), Vec3f(0, 0, 1)};  // one would suffice: over-constrained
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < body.lattice().position.size(); ++i) {
        const Vec3d rest = body.lattice().position[i];
        const bool edge = std::fabs(rest.x() - 0.5 * set_side) > 0.49 * set_side &&
                          std::fabs(rest.y() - 0.5 * set_side) > 0.49 * set_side;
        if (rest.z() < 1e-9) {
            body.hold(i);
        } else if (edge && rest.z() > 0.99 * set_side) {
            corners.push_back(i);
        }
    }
    double time = 0.0;
    double thrown = 0.0;
    RecoveryTracker tracker(set_side, sets_watched);
    body.before_solve = [&](pbd::ImplicitMesh& mesh, const pbd::Particles& p, double) {
        mesh.springs.clear();
        for (const std::size_t i :
             time < 0.5 * sets_watched ? std::span(corners) : std::span<std::size_t>()) {
            for (const Vec3f& way : ways) {
                mesh.springs.push_back({static_cast<std::uint32_t>(i),
                                        p.rest[i] + static_cast<float>(set_side) * way, stiffness});
            }
        }
    };
    body.contact = [&](pbd::Particles& p, double dt, double) {
        for (const std::size_t i :
             time < 0.5 * sets_watched ? std::span(corners) : std::span<std::size_t>()) {
            for (const Vec3f& way : ways) {
                Vec3f anchor = p.rest[i] + static_cast<float>(set_side) * way;
                pbd::project_link(anchor, p.predicted[i], 0.0f, p.inverse_mass[i], 0.0f, stiffness,
                                  static_cast<float>(dt));
            }
        }
    };
    body.watch = [&](const pbd::Particles& particles) {
        time += setting.step;
        const double away = farthest_from_rest(particles);
        thrown = std::max(thrown, time < 0.5 * sets_watched ? std::min(away, 2.0 * set_side) : 0.0);
        tracker.observe(time, away, kinetic_energy(particles));
        for (const Quatf& rotation : body.shapes().rotation()) {
            tracker.observe(rotation);
        }
    };
    body.settle(sets_watched);
    return tracker.result(thrown);
}

}  // namespace

void degenerate_and_conflicting_sets(const Sweep& sweep, StabilityTable& maps) {
    const std::vector<Placement> placements = {
        {"scattered",
         [](const Vec3f&, Random& random) {
             return Vec3f(static_cast<float>(set_side) *
                          Vec3f(random.uniform(), random.uniform(), random.uniform()));
         }},
        {"turned 180 deg", [](const Vec3f& p, Random&) { return Vec3f(-p.x(), -p.y(), p.z()); }},
        {"in one point", [](const Vec3f&, Random& random) {
             return Vec3f(1e-6f * Vec3f(random.normal(), random.normal(), random.normal()));
         }}};
    for (const Method method : sweep.methods) {
        for (const auto& [column, rate] : columns_of(sweep, method)) {
            const auto add = [&, &column = column](std::string_view map, std::string_view row,
                                                   const auto& course) {
                maps.add(set_figure, map, name_of(method), row, column, course);
            };
            if (!is_implicit(method)) {  // flat cells are left out
                for (const Shape& shape : shapes()) {
                    for (const Placement& placement : placements) {
                        add("clusters without volume", shape.name + ", " + placement.name,
                            [&, rate = rate] { return lone_cluster(shape, placement, method, rate); });
                    }
                }
            }
            for (const float stiffness : {1.0f, 1e2f, 1e4f, 1e6f}) {
                add("links against the body", fmt::format("{:g} N/m", stiffness),
                    [&, rate = rate] { return links_against_body(method, rate, stiffness); });
            }
        }
    }
    for (const double rate : sweep.rates) {
        for (const float ratio : {1.0f, 1e2f, 1e4f}) {
            maps.add(set_figure, "two links, 10 and 20 mm", "links, XPBD", fmt::format("1:{:g}", ratio),
                     step_name(rate), [&] { return two_links(ratio, rate); });
        }
    }
}

}  // namespace eti::bench
