// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/block_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "server/pbd/contact/contact.hpp"
#include "tests/bench/server/accuracy/scene_contact.hpp"
#include "tests/bench/server/source_file.hpp"

namespace eti::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double lowered = 0.05e-3;  // [m] per step
constexpr double slow = 2e-5;        // [m/s], of what has come to rest
constexpr int patience = 600;        // [steps] to come to rest
constexpr double slow_bar = 1e-5;    // the same for the bar, which sinks slowly
constexpr int patience_bar = 4000;
constexpr int averaged = 20;  // [steps] at rest, over which a force is averaged

Json reference_of(std::string_view name) {
    const std::filesystem::path file = source_file(fmt::format("tests/validation/references/{}.json", name));
    std::ifstream in(file);
    if (!in) {
        throw std::runtime_error("cannot read " + file.lexically_normal().string() +
                                 "; run eti-bench from the folder that it was built from");
    }
    return Json::parse(in);
}

/// Rows of one ratio.
std::vector<Json> at_ratio(const Json& reference, double nu) {
    std::vector<Json> rows;
    for (const Json& row : reference.at("results")) {
        if (std::fabs(row.at("nu").get<double>() - nu) < 1e-6) {
            rows.push_back(row);
        }
    }
    if (rows.empty()) {
        throw std::runtime_error(fmt::format("the reference of '{}' has no Poisson's ratio {:g}",
                                             reference.at("case").get<std::string>(), nu));
    }
    return rows;
}

Vec3d metres(const Json& millimetres) {
    return 1e-3 *
           Vec3d(millimetres[0].get<double>(), millimetres[1].get<double>(), millimetres[2].get<double>());
}

/// A frictionless capsule along x, or a sphere, over the middle of a block's top.
class PressingCapsule {
  public:
    /// `half`: of the axis [m]. Hold particles of the body before.
    PressingCapsule(BlockBody& body, double half, double radius)
        : body_(body),
          radius_(static_cast<float>(radius)),
          top_(0.5 * body.lattice().position.back()),
          contact_(body,
                   {Vec3f(static_cast<float>(-half), 0, 0), Vec3f(static_cast<float>(half), 0, 0), radius_}),
          half_(static_cast<float>(half)) {
        top_.z() = body.lattice().position.back().z();
        body.before_solve = [this](pbd::ImplicitMesh& mesh, const pbd::Particles& p, double) {
            const RigidTransform pose{Quatf::Identity(), centre()};
            contact_.find(mesh, p, pose, pose);
            for (pbd::MeshContact& c : mesh.contacts) {
                c.friction = 0.0f;
            }
        };
        body.after_solve = [this](pbd::ImplicitMesh& mesh, const pbd::Particles&, double dt) {
            impulse_ += dt * SceneContact::reaction(mesh);
        };
        body.contact = [this](pbd::Particles& p, double dt, double) { push(p, dt); };
    }
    PressingCapsule(const PressingCapsule&) = delete;
    PressingCapsule& operator=(const PressingCapsule&) = delete;
    ~PressingCapsule() = default;

    void lower_to(double depth) { depth_ = static_cast<float>(depth); }
    /// Impulse [N s] on the indenter since the last call, upwards.
    [[nodiscard]] double take_impulse() { return std::exchange(impulse_, 0.0); }
    [[nodiscard]] const Vec3d& top() const { return top_; }

  private:
    [[nodiscard]] Vec3f centre() const { return top_.cast<float>() + Vec3f(0.0f, 0.0f, radius_ - depth_); }
    void push(pbd::Particles& p, double dt) {
        const Vec3f a = centre() - Vec3f(half_, 0, 0);
        const Vec3f b = centre() + Vec3f(half_, 0, 0);
        const pbd::MovingCapsule capsule{a, b, a, b, radius_};
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                const Vec3f move = pbd::push_out_of(capsule, p.position[i], p.predicted[i], 0.0f, 0.0f);
                p.predicted[i] += move;
                impulse_ -= static_cast<double>(move.z()) * body_.mass(i) / dt;
            }
        }
    }

    BlockBody& body_;
    float radius_, depth_ = 0.0f;
    Vec3d top_;
    SceneContact contact_;
    float half_;
    double impulse_ = 0.0;
};

/// Wall time of the steps of a body.
class Stopwatch {
  public:
    explicit Stopwatch(const BodySettings& setting) : step_(setting.step) {}
    void count(int steps) { steps_ += steps; }
    [[nodiscard]] double frame_ms() const {
        const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
        return wall.count() / (steps_ * step_ * 90.0);
    }

  private:
    double step_;
    int steps_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void hold_where(BlockBody& body, int axis) {
    for (std::size_t i = 0; i < body.lattice().position.size(); ++i) {
        if (body.lattice().position[i][axis] < 1e-9) {
            body.hold(i);
        }
    }
}

double shape_error(const BlockBody& body, const Vec3d& below, const Json& points, const Json& displacements) {
    double squared = 0.0;
    double whole = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3d expected = metres(displacements[k]);
        squared += (body.displacement_at(metres(points[k]) + below) - expected).squaredNorm();
        whole += expected.squaredNorm();
    }
    return std::sqrt(squared / whole);
}

BlockOutcome press_block(const Json& reference, const BodySettings& setting,
                         const std::array<int, 3>& size_mm, double half, double radius) {
    BlockBody body(size_mm[0], size_mm[1], size_mm[2], setting);
    hold_where(body, 2);
    body.start();
    PressingCapsule indenter(body, half, radius);
    BlockOutcome out;
    out.particles = body.lattice().position.size();
    Stopwatch watch(setting);
    double depth = 0.0;
    for (const Json& row : at_ratio(reference, setting.poisson_ratio)) {
        BlockLoad& load = out.loads.emplace_back();
        load.depth_mm = row.at("depth_mm").get<double>();
        load.reference = row.at("force_n").get<double>();
        while (depth < 1e-3 * load.depth_mm - 1e-9 && body.is_finite()) {
            depth = std::min(depth + lowered, 1e-3 * load.depth_mm);
            indenter.lower_to(depth);
            body.step();
            watch.count(1);
        }
        load.steps = body.settle_below(slow, patience);
        (void)indenter.take_impulse();
        for (int k = 0; k < averaged; ++k) {
            body.step();
        }
        watch.count(load.steps + averaged);
        load.value = body.is_finite() ? indenter.take_impulse() / (averaged * setting.step)
                                      : std::numeric_limits<double>::infinity();
        if (row.contains("displacements_mm")) {
            // The reference's origin is below the middle of the top.
            const Vec3d below(indenter.top().x(), indenter.top().y(), 0.0);
            load.shape_error =
                shape_error(body, below, reference.at("points_mm"), row.at("displacements_mm"));
        }
    }
    out.frame_ms = watch.frame_ms();
    return out;
}

BlockOutcome sag(const Json& reference, const BodySettings& setting) {
    BlockBody body(40, 10, 10, setting);
    hold_where(body, 0);
    body.gravity = Vec3d(0, 0, -9.81);
    body.start();
    Stopwatch watch(setting);
    BlockLoad load;
    load.steps = body.settle_below(slow_bar, patience_bar);
    watch.count(load.steps);
    load.value = body.is_finite() ? -1e3 * body.displacement_at({40e-3, 5e-3, 5e-3}).z()
                                  : std::numeric_limits<double>::infinity();
    load.reference = at_ratio(reference, setting.poisson_ratio).front().at("sag_mm").get<double>();
    return {{load}, watch.frame_ms(), body.lattice().position.size()};
}

}  // namespace

BlockOutcome run_block(std::string_view name, BodySettings setting) {
    const Json reference = reference_of(name);
    setting.youngs_modulus = reference.at("young_pa").get<double>();
    if (name == "bar") {
        return sag(reference, setting);
    }
    return name == "sphere" ? press_block(reference, setting, {40, 40, 20}, 0.0, 10e-3)
                            : press_block(reference, setting, {20, 20, 10}, 40e-3, 5e-3);
}

}  // namespace eti::bench
