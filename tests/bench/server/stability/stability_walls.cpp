// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Do tube and blade pass through thin walls?
#include "common/mesh/intersect.hpp"
#include "common/model/pace.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/blade.hpp"
#include "server/scene/tube.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr float wall_spacing = 1e-3f;  // [m], of particles, as the patient's epiglottis and larynx
constexpr int across = 13;             // particles along x and y
constexpr double walls_watched = 2.0;  // [s]
constexpr double walls_pressed = 0.5;  // [s], time from which the tool retracts
constexpr float start = 8e-3f;         // [m], of the tool's surface over the wall
constexpr double wall_size = 10e-3;    // [m], what 1 % refers to
const Vec3f far_away(0.0f, 0.5f, 0.5f);

enum class Target { flap, cords, wall, shell };

struct Case {
    Target target = Target::flap;
    int layers = 1;  ///< of particles; the shell is as many millimetres thick
    bool end_on = true;
    float speed = 1.0f;  ///< [m/s], of the hand
    int substeps = 8;
};

/// Travel of the hand [m] beyond first contact. A flap bends away and cords part; a wall held all round is
/// stretched to half its width; a solid one stops the tube, which buckles.
float travel(const Case& c) {
    switch (c.target) {
        case Target::flap:
            return c.end_on ? 15e-3f : 10e-3f;
        case Target::cords:
            return c.end_on ? 15e-3f : 6e-3f;
        case Target::wall:
            return 6e-3f;
        case Target::shell:
            break;
    }
    return 20e-3f;
}

/// A sheet of tissue about z = 0, as stiff as the patient's. It is a flap like the epiglottis, one cluster
/// hinged along its edge; two cords held at their outer sides with a slit narrower than the tube; or a wall
/// held all round.
class Sheet {
  public:
    Sheet(Target target, int layers) : target_(target), layers_(layers) {
        if (target == Target::shell) {
            return;
        }
        number_.assign(static_cast<std::size_t>(across * across), none);
        pbd::Particles& p = body.particles;
        for (int k = 0; k < across * across; ++k) {
            if (part(k % across) != 0) {
                number_[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(p.size());
                p.resize(p.size() + static_cast<std::size_t>(layers));
                for (int layer = 0; layer < layers; ++layer) {
                    place(k % across, k / across, layer);
                }
            }
        }
        p.position = p.predicted = p.rest;
        body.settings.damping = damping;
        add_clusters();
    }

    /// Whether a line passes through the sheet's middle.
    [[nodiscard]] bool crossed_by(std::span<const Vec3f> line) const {
        if (target_ == Target::shell) {
            const Vec3f a(-wall_half, -wall_half, 0), b(wall_half, -wall_half, 0), c(wall_half, wall_half, 0),
                d(-wall_half, wall_half, 0);
            return crosses_any(line, a, b, c) || crosses_any(line, a, c, d);
        }
        for (int y = 0; y + 1 < across; ++y) {
            for (int x = 0; x + 1 < across; ++x) {
                if (part(x) != 0 && part(x) == part(x + 1)) {
                    const Vec3f a = middle(x, y), b = middle(x + 1, y), c = middle(x + 1, y + 1),
                                d = middle(x, y + 1);
                    if (crosses_any(line, a, b, c) || crosses_any(line, a, c, d)) {
                        return true;
                    }
                }
            }
        }
        return false;
    }

    /// Solid box for the shell, nothing otherwise.
    [[nodiscard]] DistanceGrid solid() const {
        DistanceGrid grid;
        if (target_ != Target::shell) {
            grid.size = {2, 2, 2};
            grid.value.assign(8, 1.0f);
            return grid;
        }
        grid.origin = Vec3f::Constant(-0.03f);
        grid.size = {61, 61, 61};
        const Vec3f half(wall_half, wall_half, 0.5e-3f * static_cast<float>(layers_));
        for (int z = 0; z < grid.size[2]; ++z) {
            for (int y = 0; y < grid.size[1]; ++y) {
                for (int x = 0; x < grid.size[0]; ++x) {
                    const Vec3f beyond = grid.node(x, y, z).cwiseAbs() - half;
                    const Vec3f outside = beyond.cwiseMax(0.0f);
                    grid.value.push_back(outside.norm() + std::min(beyond.maxCoeff(), 0.0f));
                }
            }
        }
        return grid;
    }

    pbd::SoftBody body;

  private:
    static constexpr std::uint32_t none = ~0u;
    static constexpr float wall_half = 20e-3f;  // [m]
    static constexpr float damping = 12.0f;     // [1/s]
    static constexpr int hinge = 2;             // rows

    /// Index of the piece that a column of particles belongs to; 0: none, in the slit.
    [[nodiscard]] int part(int x) const {
        constexpr int slit = across / 2;
        return target_ != Target::cords || x < slit ? 1 : x > slit ? 2 : 0;
    }

    [[nodiscard]] bool held(int x, int y) const {
        const bool ends = y == 0 || y == across - 1;
        const bool sides = x < hinge || x >= across - hinge;
        return target_ == Target::flap ? y < hinge : sides || (target_ == Target::wall && ends);
    }

    void place(int x, int y, int layer) {
        pbd::Particles& p = body.particles;
        const std::size_t i = number(x, y) + static_cast<std::size_t>(layer);
        p.rest[i] =
            wall_spacing * Vec3f(static_cast<float>(x - across / 2), static_cast<float>(y - across / 2),
                                 static_cast<float>(layer) - 0.5f * static_cast<float>(layers_ - 1));
        p.radius[i] = 0.5f * wall_spacing;
        p.channels[i] = pbd::channel::blade | pbd::channel::tube;
        p.inverse_mass[i] = held(x, y) ? 0.0f : 1.0f / mass;
    }

    /// One cluster around every column of particles with its neighbours; the flap is one cluster, with such
    /// ones along its hinge.
    void add_clusters() {
        const auto soft = static_cast<float>(BodySettings{}.youngs_modulus);
        pbd::ShapeMatching::Description out;
        out.first = {0};
        const auto close = [&](float modulus) {
            out.first.push_back(static_cast<std::uint32_t>(out.member.size()));
            out.youngs_modulus.push_back(modulus);
        };
        if (target_ == Target::flap) {
            add_members(out, 0, across, hinge, across);
            close(40.0f * soft);
        }
        for (int k = 0; k < across * across; ++k) {
            const int x = k % across;
            const int y = k / across;
            if (part(x) != 0 && (target_ != Target::flap || y < 2 * hinge)) {
                add_members(out, x - 1, x + 2, y - 1, y + 2, part(x));
                close(target_ == Target::flap ? soft : 4.0f * soft);
            }
        }
        out.particle_volume.assign(body.particles.size(), wall_spacing * wall_spacing * wall_spacing);
        out.fitting_mass.assign(body.particles.size(), mass);
        body.shapes.configure(out, body.particles);
        body.reset();
    }

    void add_members(pbd::ShapeMatching::Description& out, int x0, int x1, int y0, int y1,
                     int piece = 1) const {
        for (int y = std::max(y0, 0); y < std::min(y1, across); ++y) {
            for (int x = std::max(x0, 0); x < std::min(x1, across); ++x) {
                for (int layer = 0; part(x) == piece && layer < layers_; ++layer) {
                    out.member.push_back(static_cast<std::uint32_t>(number(x, y)) +
                                         static_cast<std::uint32_t>(layer));
                }
            }
        }
    }

    [[nodiscard]] std::size_t number(int x, int y) const {
        return number_[static_cast<std::size_t>(y * across + x)];
    }
    [[nodiscard]] Vec3f middle(int x, int y) const {
        Vec3f sum = Vec3f::Zero();
        for (int layer = 0; layer < layers_; ++layer) {
            sum += body.particles.position[number(x, y) + static_cast<std::size_t>(layer)];
        }
        return sum / static_cast<float>(layers_);
    }
    [[nodiscard]] static bool crosses_any(std::span<const Vec3f> line, const Vec3f& a, const Vec3f& b,
                                          const Vec3f& c) {
        for (std::size_t i = 1; i < line.size(); ++i) {
            if (crosses(line[i - 1], line[i], a, b, c)) {
                return true;
            }
        }
        return false;
    }

    static constexpr float mass = 4e3f * wall_spacing * wall_spacing * wall_spacing;
    Target target_;
    int layers_;
    std::vector<std::uint32_t> number_;
};

/// Height [m] of a hand that approaches, stays, and retracts.
float height_at(double time, const Case& c) {
    const auto t = static_cast<float>(time);
    const float down = std::max(start - c.speed * t, -travel(c));
    return time < walls_pressed ? down
                                : std::min(down + 0.2f * (t - static_cast<float>(walls_pressed)), start);
}

/// The tool's axis over a wall at z = 0, where `height` [m] is that of its lowest side. End on, it points
/// down at the middle, or at a cord's edge; otherwise it lies across the flap, or along a cord.
RigidTransform pose(const Case& c, float height, float radius, float tip_from_origin) {
    const bool cords = c.target == Target::cords;
    const float top = 0.5f * wall_spacing * static_cast<float>(c.layers) + height + radius;
    const Vec3f along = c.end_on                   ? Vec3f(0, 0, -1)
                        : c.target == Target::flap ? Vec3f(1, 0, 0)
                                                   : Vec3f(0, 1, 0);
    const Vec3f tip = c.end_on                   ? Vec3f(cords ? 1.5e-3f : 0.0f, 0, top)
                      : c.target == Target::flap ? Vec3f(10e-3f, 2e-3f, top)
                                                 : Vec3f(cords ? 2.5e-3f : 0.0f, 10e-3f, top);
    return {Quatf::FromTwoVectors(Vec3f(0, 0, 1), along), tip - tip_from_origin * along};
}

/// Fails if the tool's axis ever passes through the wall, or a particle is lost; recovers if it holds, but is
/// not back within 1 % at the end.
class Run {
  public:
    explicit Run(const Case& c) : c_(c), sheet_(c.target, c.layers), shell_(sheet_.solid()) {}

    RecoveryResult tube() {
        Tube tube;
        tube.curve_radius = 1e3f;
        const auto at = [&](double time) {
            return pose(c_, height_at(time, c_), 0.5f * tube.outer_diameter, tube.grip_from_tip);
        };
        const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
        const RigidTransform parked{Quatf::Identity(), far_away};
        scene::TubeContact contact(tube, scope, at(0.0));
        std::vector<Vec3f> line;
        return follow(
            [&](double from, double to) {
                contact.begin_step(sheet_.body.particles, at(from), at(to), parked, parked);
            },
            [&](float dt, float, float end) { contact.predict(dt, end, patient::gravity(0.0f)); },
            [&](float, float begin, float end) {
                contact.project(sheet_.body.particles, shell_, begin, end);
                contact.finish();
            },
            [&]() -> std::span<const Vec3f> {
                contact.nodes(line);
                return line;
            });
    }

    RecoveryResult blade() {
        const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
        const Capsule& distal = scope.capsules[2];
        const auto at = [&](double time) {
            return pose(c_, height_at(time, c_), distal.radius, distal.b.z());
        };
        scene::BladeContact contact(scope);
        std::array<Vec3f, 2> line;
        double now = 0.0;
        return follow(
            [&](double from, double to) {
                now = to;
                contact.begin_step(sheet_.body.particles, at(from), at(to));
            },
            [](float, float, float) {},
            [&](float dt, float begin, float end) { contact.project(sheet_.body.particles, begin, end, dt); },
            [&]() -> std::span<const Vec3f> {
                line = {at(now) * distal.a, at(now) * distal.b};
                return line;
            });
    }

  private:
    /// Steps as in the scene.
    template <class Begin, class Predict, class Project, class Line>
    RecoveryResult follow(const Begin& begin_step, const Predict& predict, const Project& project,
                          const Line& line) {
        RecoveryTracker tracker(wall_size, walls_watched);
        pbd::SoftBody& body = sheet_.body;
        bool passed = false;
        const auto steps = static_cast<int>(walls_watched * steps_per_second);
        for (int k = 0; k < steps; ++k) {
            const double from = static_cast<double>(k) / steps_per_second;
            const double to = static_cast<double>(k + 1) / steps_per_second;
            begin_step(from, to);
            const float dt = step_duration / static_cast<float>(c_.substeps);
            for (int s = 0; s < c_.substeps; ++s) {
                const float begin = static_cast<float>(s) / static_cast<float>(c_.substeps);
                const float end = static_cast<float>(s + 1) / static_cast<float>(c_.substeps);
                body.predict(dt, 1.0f);
                predict(dt, begin, end);
                body.project(dt);
                project(dt, begin, end);
                body.finish(dt);
            }
            const std::span<const Vec3f> axis = line();
            passed = passed || sheet_.crossed_by(axis) ||
                     !std::ranges::all_of(axis, [](const Vec3f& p) { return p.allFinite(); });
            tracker.observe(to, farthest_from_rest(body.particles), kinetic_energy(body.particles));
            for (const Quatf& rotation : body.shapes.rotation()) {
                tracker.observe(rotation);
            }
        }
        RecoveryResult course = tracker.result(1.0);
        if (passed || !(course.residual < 10.0)) {  // a decimetre: lost
            course.fate = Fate::fails;
        } else if (std::isnan(course.return_time)) {
            course.fate = Fate::recovers;
        }
        return course;
    }

    Case c_;
    Sheet sheet_;
    DistanceGrid shell_;
};

std::string name_of(Target target) {
    switch (target) {
        case Target::flap:
            return "flap";
        case Target::cords:
            return "cords";
        case Target::wall:
            return "wall of particles";
        case Target::shell:
            break;
    }
    return "wall of the shell";
}

}  // namespace

void tools_against_thin_walls(const Sweep& sweep, StabilityTable& maps) {
    const int shipped = Scenario::Physics{}.substeps;
    const std::vector<int> substeps = sweep.quick ? std::vector{shipped} : std::vector{1, 4, shipped};
    const std::vector<int> layers = sweep.quick ? std::vector{1} : std::vector{1, 2, 3};
    const std::vector<float> speeds =
        sweep.quick ? std::vector{1.0f} : std::vector{0.1f, 0.3f, 1.0f, 3.0f, 10.0f};
    for (const Target target : {Target::flap, Target::cords, Target::wall, Target::shell}) {
        for (const int count : substeps) {
            for (const int thickness : layers) {
                for (const bool end_on : {true, false}) {
                    if (target == Target::wall && !end_on) {
                        continue;  // its frame would touch the wall
                    }
                    for (const float speed : speeds) {
                        const Case c{target, thickness, end_on, speed, count};
                        const std::string row =
                            fmt::format("{} mm, {}", thickness, end_on ? "end on" : "broadside");
                        const std::string column = fmt::format("{:g} m/s", speed);
                        const std::string step = step_name(steps_per_second * count);
                        maps.add("walls", "tube on " + name_of(target), step, row, column,
                                 [&] { return Run(c).tube(); });
                        // The rigid layer, which has tests of its own, keeps the blade out of the shell.
                        if (target != Target::shell) {
                            maps.add("walls", "blade on " + name_of(target), step, row, column,
                                     [&] { return Run(c).blade(); });
                        }
                    }
                }
            }
        }
    }
}

}  // namespace eti::bench
