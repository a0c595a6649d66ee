// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/haptics/closed_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "devices/haptics/haptic_loop.hpp"
#include "server/rigid/rigid_layer.hpp"

namespace eti::validation {

namespace {

using devices::SceneState;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t step_ns = 1'000'000'000 / 180;
constexpr std::int64_t origin_ns = 1'000 * ms;  // never 0: a timestamp of 0 means that nothing has arrived
constexpr float above = 5e-3f, pressed = -4e-3f, deeper = -6e-3f;  // [m], of the blade's underside
constexpr float approach = 0.05f;                                  // [m/s]
constexpr int bumped_at = 2000, held_from = 3000, deeper_at = 4000, cycles = 6200;

/// Follows the case's trajectory.
class PlannedHand final : public HeldDevice {
  public:
    PlannedHand(const LoopCase& loop, const Laryngoscope& scope)
        : PlannedHand(loop, scope.capsules[loop.move == Move::lever ? 2 : 1]) {}

    void want(int cycle) {
        const float way = std::max(pressed, above - approach * 1e-3f * static_cast<float>(cycle));
        wanted_ = cycle >= deeper_at ? deeper : way;
        if (cycle >= bumped_at && cycle < bumped_at + 20) {
            wanted_ += 1e-3f;
        }
    }
    /// Height of the blade's underside above the surface [m]; for a lever, at its end.
    [[nodiscard]] float height() const { return (pose() * end()).y() - part_.radius; }

    [[nodiscard]] RigidTransform start() const { return pose_at(above, lever_, part_); }

  private:
    PlannedHand(const LoopCase& loop, const Capsule& part)
        : HeldDevice(loop.motors, settings_of(loop), pose_at(above, loop.move == Move::lever, part)),
          lever_(loop.move == Move::lever),
          part_(part) {}
    [[nodiscard]] RigidTransform wanted() override { return pose_at(wanted_, lever_, part_); }
    static HandSettings settings_of(const LoopCase& loop) {
        HandSettings settings;
        settings.hand_stiffness = loop.grip.stiffness;
        settings.hand_damping = loop.grip.damping;
        if (loop.move == Move::lever) {
            settings.hand_rotational_stiffness *= loop.grip.share;
            settings.hand_rotational_damping *= loop.grip.share;
        }
        return settings;
    }
    [[nodiscard]] Vec3f end() const { return lever_ ? part_.b : Vec3f(Vec3f::Zero()); }
    [[nodiscard]] static RigidTransform pose_at(float height, bool lever, const Capsule& part) {
        if (lever) {
            const float turn = std::asin((above - height) / part.b.z());
            return {quaternion_from({turn, 0.0f, 0.0f}), {0.0f, part.radius + above, 0.0f}};
        }
        return {Quatf::Identity(), {0.0f, part.radius + height, 0.0f}};
    }

    bool lever_;
    Capsule part_;
    float wanted_ = above;
};

/// A device moved kinematically, whatever force it gets: at rest, at a constant speed, and abruptly at rest
/// again.
class CarriedDevice final : public devices::Sensor {
  public:
    CarriedDevice(float height, float speed, int from, int to)
        : height_(height), speed_(speed), from_(from), to_(to) {}

    devices::Reading exchange(const Wrench&, float elapsed) override {
        const bool moves = elapsed > 0.0f && cycle_ >= from_ && cycle_ < to_;
        cycle_ += elapsed > 0.0f ? 1 : 0;
        devices::Reading reading;
        reading.motion.velocity = {moves ? speed_ : 0.0f, 0.0f, 0.0f};
        way_ += 1e-3f * reading.motion.velocity.x();
        const float step = HandSettings{}.encoder_step;
        reading.motion.pose.translation = {std::round(way_ / step) * step, height_, 0.0f};
        reading.sample = ++sample_;
        return reading;
    }

  private:
    float height_, speed_;
    int from_, to_;
    int cycle_ = 0;
    float way_ = 0.0f;  // [m]
    std::uint64_t sample_ = 0;
};

/// [m], height of the patient's surface.
float surface_at(const Moving& patient, double time) {
    const double moved = std::abs(patient.speed) * std::max(0.0, time - patient.from) / patient.reach;
    const double phase = std::fmod(moved, 4.0);
    const double away = phase < 1.0 ? phase : phase < 3.0 ? 2.0 - phase : phase - 4.0;
    return static_cast<float>(-std::copysign(patient.reach, patient.speed) * away);
}

TriangleMesh floor_mesh() {
    TriangleMesh mesh;
    constexpr int n = 4;
    constexpr float cell = 0.1f;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            mesh.vertices.push_back(
                {cell * static_cast<float>(i) - 0.2f, 0.0f, cell * static_cast<float>(j) - 0.15f});
        }
    }
    const auto at = [](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
            mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
        }
    }
    return mesh;
}

/// The server: the rigid layer, and spring-borne particles where there is tissue.
class Server {
  public:
    Server(const LoopCase& loop, const Laryngoscope& scope, const RigidTransform& start)
        : scope_(scope),
          soft_(loop.medium == Medium::tissue),
          shell_(soft_ ? TriangleMesh{} : floor_mesh()),
          layer_(scope, shell_, std::vector<Tissue>(shell_.triangles.size(), Tissue::upper_gum)) {
        layer_.reset(start);
        device_ = start;
        // As many springs as give the half-space the tongue's stiffness in the displacement law's table.
        per_particle_ = devices::tissue_stiffness()[static_cast<std::size_t>(Tissue::tongue)] /
                        static_cast<float>(rows * columns);
    }

    void hear(const RigidTransform& device) { device_ = device; }

    /// `surface` [m]: its height.
    void step(SceneState& out, float surface) {
        if (surface != surface_ && !soft_) {
            TriangleMesh moved = shell_;
            for (Vec3f& vertex : moved.vertices) {
                vertex.y() += surface;
            }
            layer_.move_shell(moved.vertices);
        }
        surface_ = surface;
        const rigid::ProxyResult& result = layer_.step(device_, 1.0f / 180.0f);
        out.proxy.proxy = {result.pose, result.velocity, result.angular_velocity};
        out.proxy.device = device_;
        out.proxy.contacts = std::min(result.contacts.size(), devices::ProxyReport::max_contacts);
        for (std::size_t i = 0; i < out.proxy.contacts; ++i) {
            out.proxy.normals[i] = result.contacts[i].normal;
        }
        out.proxy.contact_centre = centre_of(result.contacts);
        out.blade = scope_.capsules;
        out.tissue.count = 0;
        out.tissue.wrench = {};
        out.tissue.proxy = result.pose;
        if (soft_) {
            press(result.pose, out.tissue);
        }
    }

  private:
    static Vec3f centre_of(const std::vector<rigid::Contact>& contacts) {
        Vec3f weighted = Vec3f::Zero();
        float force = 0.0f;
        for (const rigid::Contact& contact : contacts) {
            weighted += contact.force * contact.position;
            force += contact.force;
        }
        return force > 0.0f ? Vec3f(weighted / force) : weighted;
    }

    static constexpr int rows = 8,
                         columns =
                             3;  // of particles under the blade, few enough that all make contact at once

    /// A lattice of particles under the proximal blade, each on a vertical spring.
    void press(const RigidTransform& pose, devices::TissueReport& report) const {
        const Capsule& blade = scope_.capsules[1];
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                const float x = 0.5e-3f * static_cast<float>(column - 1);
                const float z = 5e-3f * static_cast<float>(row + 1);
                const float height = pose.translation.y() - std::sqrt(blade.radius * blade.radius - x * x);
                const float underside = height - surface_;
                if (underside >= 0.0f) {
                    continue;
                }
                devices::TissuePoint& point = report.points[report.count++];
                point = {{x, height, z},
                         {x, surface_, z},
                         0.5e-3f,
                         Tissue::tongue,
                         {0.0f, -per_particle_ * underside, 0.0f}};
                report.wrench.force += point.force;
                report.wrench.torque += (point.position - pose.translation).cross(point.force);
            }
        }
    }

    Laryngoscope scope_;
    bool soft_;
    TriangleMesh shell_;
    rigid::RigidLayer layer_;
    RigidTransform device_;
    float per_particle_ = 0.0f;  // [N/m]
    float surface_ = 0.0f;       // [m]
};

/// The server behind the case's channel; its latest message is in `newest`.
class FarServer {
  public:
    FarServer(const LoopCase& loop, const Laryngoscope& scope, const RigidTransform& start)
        : loop_(loop), server_(loop, scope, start), random_(loop.seed) {}

    /// Advances the clock to `now`: the server steps when due, and `newest` holds the last arrival.
    void advance(std::int64_t now) {
        if (next_step_ <= now) {
            const std::int64_t missed = loop_.gaps.caught_up ? (next_step_ - last_step_) / step_ns : 1;
            last_step_ = next_step_;
            next_step_ += step_ns;
            if (loop_.gaps.longest > 0.0 && next_step_ >= next_gap_) {
                const double gap = loop_.gaps.shortest + (loop_.gaps.longest - loop_.gaps.shortest) *
                                                             static_cast<double>(random_.uniform());
                next_step_ += static_cast<std::int64_t>(1e9 * gap) - step_ns;
                const bool again = ++gaps_ % loop_.gaps.in_a_row != 0;
                next_gap_ = next_step_ + (again ? 0 : static_cast<std::int64_t>(1e9 * loop_.gaps.every));
            }
            RigidTransform device;
            if (up_.receive(now, device)) {
                server_.hear(device);
            }
            for (std::int64_t step = missed - 1; step >= 0; --step) {
                server_.step(state_,
                             surface_at(loop_.patient,
                                        1e-9 * static_cast<double>(last_step_ - origin_ns - step * step_ns)));
            }
            down_.send(state_, now, loop_.channel, random_);
        }
        if (down_.receive(now, arrived_)) {
            arrived_.proxy_arrived = arrived_.tissue_arrived = now;
            newest.write(arrived_);
        }
    }
    void send(const RigidTransform& device, std::int64_t now) {
        up_.send(device, now, loop_.channel, random_);
    }

    Mailbox<SceneState> newest;

  private:
    const LoopCase& loop_;
    Server server_;
    Random random_;
    Line<RigidTransform> up_;
    Line<SceneState> down_;
    SceneState state_, arrived_;
    std::int64_t last_step_ = origin_ns - step_ns, next_step_ = origin_ns;
    std::int64_t next_gap_ = origin_ns + static_cast<std::int64_t>(1e9 * loop_.gaps.from);
    int gaps_ = 0;
};

devices::RenderSettings settings_of(const LoopCase& loop) {
    devices::RenderSettings settings;
    settings.soft_force = loop.law;
    settings.passivity.on = loop.passivity;
    settings.safety = loop.safety;
    if (loop.motors == Motors::three) {
        settings.torque = false;
        settings.gimbal = HeldDevice::gimbal;
        settings.coupling.torque_limit = 0.0f;
    }
    if (loop.move == Move::lever) {
        settings.coupling.rotational_stiffness = loop.stiffness;
    } else if (loop.medium == Medium::wall) {
        settings.coupling.stiffness = loop.stiffness;
    } else {
        settings.coupling.tissue_gain =
            loop.stiffness / devices::tissue_stiffness()[static_cast<std::size_t>(Tissue::tongue)];
    }
    return settings;
}

}  // namespace

void Stillness::add(int at_ms, double position) {
    if (at_ms >= 0 && at_ms < length_ms) {
        Window& window = windows_[static_cast<std::size_t>(at_ms / window_ms)];
        window.low = std::min(window.low, position);
        window.high = std::max(window.high, position);
    }
}

double Stillness::excursion() const {
    double least = 1.0;
    for (const Window& window : windows_) {
        least = window.high >= window.low ? std::min(least, window.high - window.low) : least;
    }
    return least;
}

double Stillness::dip() const {
    double most = 0.0;
    for (const Window& window : windows_) {
        most = std::max(most, window.high - window.low);
    }
    return most;
}

LoopOutcome run_loop(const LoopCase& loop) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    PlannedHand hand(loop, scope);
    const auto server = std::make_unique<FarServer>(loop, scope, hand.start());
    devices::HapticCycle cycle(hand, server->newest, settings_of(loop));

    LoopOutcome out;
    static_assert(deeper_at - held_from == Stillness::length_ms);
    Stillness still;
    std::uint64_t stale_before = 0;
    double crossed = -1.0;
    double force[2] = {0.0, 0.0}, depth[2] = {0.0, 0.0};
    for (int i = 0; i < cycles; ++i) {
        const std::int64_t now = origin_ns + i * ms;
        // Forces engage while the hand waits above the surface.
        hand.want(std::max(0, i - 700));
        server->advance(now);
        if (const auto pose = cycle.run(now)) {
            server->send(pose->pose, now);
        }
        const auto height = static_cast<double>(hand.height());
        const auto given = static_cast<double>(cycle.wrench().force.y());
        out.most_force = std::max(out.most_force, cycle.wrench().force.norm());
        out.most_torque = std::max(out.most_torque, cycle.wrench().torque.norm());
        if (crossed < 0.0 && height <= 0.0) {
            crossed = i;
        }
        if (crossed >= 0.0 && out.onset == 0.0 && given > 0.05) {
            out.onset = 1e-3 * (i - crossed);
        }
        still.add(i - held_from - 700, height);
        if (i == held_from + 700) {
            stale_before = cycle.record().stale_cycles;
        }
        if (i == deeper_at + 700) {
            out.faded = 1e-3 * static_cast<double>(cycle.record().stale_cycles - stale_before);
        }
        if (i >= held_from + 700 && i < deeper_at + 700) {
            force[0] += given;
            depth[0] -= height;
        }
        if (i >= cycles - 300) {
            force[1] += given;
            depth[1] -= height;
        }
    }
    out.excursion = still.excursion();
    out.dip = still.dip();
    const double counts[2] = {1000.0, 300.0};
    out.rendered =
        (force[1] / counts[1] - force[0] / counts[0]) / (depth[1] / counts[1] - depth[0] / counts[0]);
    out.energy_lowest = cycle.renderer().passivity().lowest();
    out.dissipated = cycle.renderer().passivity().dissipated();
    return out;
}

HeldHand hold_on(LoopCase loop) {
    constexpr int settled_at = 1700, watched_for = 3000;  // cycles
    loop.gaps.from = loop.patient.from = 1e-3 * settled_at;
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    PlannedHand hand(loop, scope);
    const auto server = std::make_unique<FarServer>(loop, scope, hand.start());
    devices::HapticCycle cycle(hand, server->newest, settings_of(loop));
    HeldHand out;
    std::uint64_t stale_before = 0;
    for (int i = 0; i < settled_at + watched_for; ++i) {
        const std::int64_t now = origin_ns + i * ms;
        hand.want(std::clamp(i - 700, 0, bumped_at - 1));
        server->advance(now);
        if (const auto pose = cycle.run(now)) {
            server->send(pose->pose, now);
        }
        if (i < settled_at) {
            stale_before = cycle.record().stale_cycles;
            continue;
        }
        out.height.push_back(static_cast<double>(hand.height()));
        out.force.push_back(static_cast<double>(cycle.wrench().force.norm()));
    }
    out.whole = 1.0 - static_cast<double>(cycle.record().stale_cycles - stale_before) / watched_for;
    return out;
}

GapOutcome compare(const HeldHand& with_gaps, const HeldHand& without) {
    constexpr std::size_t rise_window = 10;  // cycles
    const auto cycles_watched = static_cast<double>(with_gaps.height.size());
    GapOutcome out;
    out.whole = with_gaps.whole;
    for (std::size_t i = 0; i < with_gaps.height.size(); ++i) {
        const double away = std::abs(with_gaps.height[i] - without.height[i]);
        out.excursion = std::max(out.excursion, away);
        out.away += away * away / cycles_watched;
        out.force += with_gaps.force[i] / cycles_watched;
        if (i >= rise_window) {
            out.rise = std::max(out.rise, with_gaps.force[i] - with_gaps.force[i - rise_window]);
        }
    }
    out.away = std::sqrt(out.away);
    return out;
}

StopOutcome stop_in_free_air(const LoopCase& loop, float speed) {
    constexpr float height = 0.05f;                              // [m], far above the floor
    constexpr int moving_from = 800, phases = 6, watched = 400;  // cycles; a server's step is 5.6 of them
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    StopOutcome out;
    for (int phase = 0; phase < phases; ++phase) {
        const int stops = moving_from + 300 + phase;
        CarriedDevice device(height, speed, moving_from, stops);
        const auto server =
            std::make_unique<FarServer>(loop, scope, RigidTransform{Quatf::Identity(), {0.0f, height, 0.0f}});
        devices::HapticCycle cycle(device, server->newest, settings_of(loop));
        for (int i = 0; i < stops + watched; ++i) {
            const std::int64_t now = origin_ns + i * ms;
            server->advance(now);
            if (const auto pose = cycle.run(now)) {
                server->send(pose->pose, now);
            }
            const float force = cycle.wrench().force.norm();
            if (i >= moving_from + 100 && i <= stops) {
                out.moving = std::max(out.moving, force);
            }
            if (i > stops) {
                out.stopped = std::max(out.stopped, force);
            }
        }
        out.engaged = out.engaged && cycle.record().engaged_cycles > static_cast<std::uint64_t>(watched);
    }
    return out;
}

double largest_stable_stiffness(LoopCase loop) {
    const bool lever = loop.move == Move::lever;
    const double lowest = lever ? 0.1 : 50.0, highest = lever ? 20.0 : 20'000.0;
    constexpr double step = 1.42, precision = 1.15;
    const auto stable = [&](double stiffness) {
        loop.stiffness = static_cast<float>(stiffness);
        return run_loop(loop).excursion <= most_excursion;
    };
    if (!stable(lowest)) {
        return 0.0;
    }
    // From below: stiffer couplings hold still again where the force limit ends a limit cycle.
    double good = lowest, bad = lowest;
    while (bad == good && good < highest) {
        bad = std::min(step * good, highest);
        if (stable(bad)) {
            good = bad;
        }
    }
    while (bad / good > precision) {
        const double middle = std::sqrt(good * bad);
        (stable(middle) ? good : bad) = middle;
    }
    return good;
}

}  // namespace eti::validation
