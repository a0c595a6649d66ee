// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The blade driven into tissue that lies on bone.
#include "common/model/pace.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/scene/tongue/tongue.hpp"
#include "tests/bench/server/accuracy/scene_contact.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr double blade_watched = 4.0;  // [s]
constexpr double blade_pressed = 1.0;  // [s], then the blade is lifted off
constexpr double height = 10e-3;
constexpr double distal_radius = 3.5e-3;       // [m], of the blade's distal capsule
constexpr std::string_view as_cut = "as cut";  // column: as the scene subdivides its step for fast blades
constexpr double gap = 0.5e-3;                 // [m], that the rigid layer keeps between blade and bone

struct Push {
    std::string name;
    double force = 0.0;  ///< [N] on a free blade; 0: it moves at `speed`
    double speed = 0.0;  ///< [m/s]
};

/// The blade's height and speed, driven by a force or kinematically.
class Driven {
  public:
    explicit Driven(const Push& push) : push_(push) {}

    /// Advances by `dt` [s]; `reaction` [N] of the tissue, upwards.
    void advance(double time, double dt, double reaction) {
        before_ = bottom_;
        if (time > blade_pressed) {
            velocity_ = push_.force > 0.0 ? 1.0 : push_.speed;
        } else if (push_.force > 0.0) {
            constexpr double mass = 0.1;  // [kg], as the proxy's
            velocity_ += dt * (reaction - push_.force) / mass;
        } else {
            velocity_ = -push_.speed;
        }
        bottom_ = std::clamp(bottom_ + dt * velocity_, gap, height + 5e-3);
        velocity_ = (bottom_ - before_) / dt;
    }

    [[nodiscard]] pbd::MovingCapsule capsule() const {
        const Capsule from = capsule_at(before_), to = capsule_at(bottom_);
        return {from.a, from.b, to.a, to.b, to.radius};
    }

    /// [m], in the last advance().
    [[nodiscard]] float travel() const { return static_cast<float>(std::fabs(bottom_ - before_)); }

    /// Pose of the capsule at height 0, at a share of the last advance().
    [[nodiscard]] RigidTransform pose(double share) const {
        return {Quatf::Identity(), Vec3d(0.0, 0.0, before_ + share * (bottom_ - before_)).cast<float>()};
    }
    [[nodiscard]] static Capsule capsule_at(double bottom) {
        const auto end = [&](double x) {
            return Vec3d(x, 10e-3, bottom + distal_radius).cast<float>().eval();
        };
        return {end(-10e-3), end(30e-3), static_cast<float>(distal_radius)};
    }

    Push push_;
    double bottom_ = height + 0.5e-3, before_ = bottom_;
    double velocity_ = 0.0;
};

/// `cut`: the blade advances by the settings' steps, each divided into as many solves as the scene uses.
RecoveryResult drive(const BodySettings& setting, bool cut, const Push& push) {
    BlockBody body(20, 20, 10, setting);
    for (std::size_t i = 0; i < body.lattice().position.size(); ++i) {
        if (body.lattice().position[i].z() < 1e-9) {
            body.hold(i);
        }
    }
    Driven blade(push);
    double time = 0.0;
    double reaction = 0.0;
    SceneContact contact(body, Driven::capsule_at(0.0));
    int solves = 1;
    int solved = 0;
    double felt = 0.0;
    if (cut) {
        body.cut = [&] {
            blade.advance(time + setting.step, setting.step, reaction);
            solves = scene::Tongue::solve_count(blade.travel(), Scenario::Physics{}.substeps);
            solved = 0;
            return solves;
        };
    }
    body.before_solve = [&](pbd::ImplicitMesh& mesh, const pbd::Particles& p, double dt) {
        time += dt;
        if (!cut) {
            blade.advance(time, dt, reaction);
            solved = 0;
        }
        contact.find(mesh, p, blade.pose(double(solved) / solves), blade.pose((solved + 1.0) / solves));
    };
    body.after_solve = [&](pbd::ImplicitMesh& mesh, const pbd::Particles&, double) {
        felt = (solved == 0 ? 0.0 : felt) + SceneContact::reaction(mesh) / solves;
        reaction = ++solved == solves ? felt : reaction;
    };
    body.contact = [&](pbd::Particles& p, double dt, double) {
        time += dt;
        blade.advance(time, dt, reaction);
        const pbd::MovingCapsule capsule = blade.capsule();
        reaction = 0.0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                const Vec3f move = pbd::push_out_of(capsule, p.position[i], p.predicted[i], 0.0f, 0.1f);
                p.predicted[i] += move;
                reaction -= static_cast<double>(move.z()) * body.mass(i) / (dt * dt);
            }
        }
        reaction = std::isfinite(reaction) ? reaction : 0.0;
    };
    RecoveryTracker tracker(height, blade_watched);
    double looked = 0.0;
    body.watch = [&](const pbd::Particles& particles) {
        looked += setting.step;
        tracker.observe(looked, farthest_from_rest(particles), kinetic_energy(particles));
        for (const Quatf& rotation : body.shapes().rotation()) {
            tracker.observe(rotation);
        }
    };
    body.settle(blade_watched);
    return tracker.result(height);
}

}  // namespace

void blade_into_tissue_on_bone(const Sweep& sweep, StabilityTable& maps) {
    for (const Method method : sweep.methods) {
        std::vector<Column> columns = columns_of(sweep, method);
        if (is_implicit(method)) {
            columns.push_back({std::string(as_cut), steps_per_second});
        }
        for (const auto& [column, rate] : columns) {
            for (const Push& push :
                 {Push{"5 N", 5.0, 0.0}, Push{"50 N", 50.0, 0.0}, Push{"0.1 m/s", 0.0, 0.1},
                  Push{"1 m/s", 0.0, 1.0}, Push{"10 m/s", 0.0, 10.0}}) {
                maps.add("contacts", "blade into tissue on bone", name_of(method), push.name, column,
                         [&, &column = column, rate = rate] {
                             return drive(with_rate(method, rate), column == as_cut, push);
                         });
            }
        }
    }
}

}  // namespace eti::bench
