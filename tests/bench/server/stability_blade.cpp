// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The blade driven into tissue that lies on bone.
#include "server/pbd/contact.hpp"
#include "tests/bench/server/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr double watched = 4.0;  // [s]
constexpr double pressed = 1.0;  // [s], then the blade is lifted off
constexpr double height = 10e-3;
constexpr double radius = 3.5e-3;  // [m], of the blade's distal capsule
constexpr double gap = 0.5e-3;     // [m], that the rigid layer keeps between blade and bone

struct Push {
    std::string name;
    double force = 0.0;  ///< [N] on a blade that is free to move; 0: it moves at `speed`
    double speed = 0.0;  ///< [m/s]
};

/// The blade's height and speed, driven by a force or by a hand that does not give way.
class Driven {
  public:
    explicit Driven(const Push& push) : push_(push) {}

    /// Moves on by `dt` [s]; `reaction` [N] of the tissue, upwards.
    void advance(double time, double dt, double reaction) {
        before_ = bottom_;
        if (time > pressed) {
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
        const auto end = [](double x, double bottom) {
            return Vec3d(x, 10e-3, bottom + radius).cast<float>().eval();
        };
        return {end(-10e-3, before_), end(30e-3, before_), end(-10e-3, bottom_), end(30e-3, bottom_),
                static_cast<float>(radius)};
    }

  private:
    Push push_;
    double bottom_ = height + 0.5e-3, before_ = bottom_;
    double velocity_ = 0.0;
};

Course drive(Method method, double rate, const Push& push) {
    const Setting setting = with_rate(method, rate);
    BlockBody body(20, 20, 10, setting);
    for (std::size_t i = 0; i < body.lattice().position.size(); ++i) {
        if (body.lattice().position[i].z() < 1e-9) {
            body.hold(i);
        }
    }
    Driven blade(push);
    double time = 0.0;
    double reaction = 0.0;
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
    Follower follower(height, watched);
    double looked = 0.0;
    body.watch = [&](const pbd::Particles& particles) {
        looked += setting.step;
        follower.look(looked, farthest_from_rest(particles), kinetic_energy(particles));
        for (const Quatf& rotation : body.shapes().rotation()) {
            follower.look(rotation);
        }
    };
    body.settle(watched);
    return follower.course(height);
}

}  // namespace

void blade_into_tissue_on_bone(const Sweep& sweep, Maps& maps) {
    for (const Method method : sweep.methods) {
        for (const double rate : sweep.rates) {
            for (const Push& push :
                 {Push{"5 N", 5.0, 0.0}, Push{"50 N", 50.0, 0.0}, Push{"0.1 m/s", 0.0, 0.1},
                  Push{"1 m/s", 0.0, 1.0}, Push{"10 m/s", 0.0, 10.0}}) {
                maps.add("contacts", "blade into tissue on bone", name_of(method), push.name, step_name(rate),
                         drive(method, rate, push));
            }
        }
    }
}

}  // namespace eti::bench
