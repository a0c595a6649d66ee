// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/rigid_layer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "server/rigid/proxy_world.hpp"

namespace eti::rigid {
namespace {

void require(bool condition, const std::string& what) {
    if (!condition) {
        throw std::invalid_argument("rigid layer: " + what);
    }
}

void check(const Laryngoscope& scope, const TriangleMesh& shell, std::span<const Tissue> tissue,
           const Settings& settings) {
    for (const Capsule& capsule : scope.capsules) {
        require(capsule.radius > 0.0f && capsule.a.allFinite() && capsule.b.allFinite(),
                "a capsule of the laryngoscope has radius " + std::to_string(capsule.radius) +
                    " m or ends that are not finite; expected a positive radius");
    }
    require(tissue.size() == shell.triangles.size(),
            "the shell has " + std::to_string(shell.triangles.size()) + " triangles and " +
                std::to_string(tissue.size()) + " tissue entries; expected one entry per triangle");
    for (const Triangle& triangle : shell.triangles) {
        for (const std::uint32_t vertex : triangle) {
            require(vertex < shell.vertices.size(), "a shell triangle refers to vertex " +
                                                        std::to_string(vertex) + " of " +
                                                        std::to_string(shell.vertices.size()));
        }
    }
    for (const Vec3f& vertex : shell.vertices) {
        require(vertex.allFinite(), "a shell vertex is not finite");
    }
    require(settings.mass > 0.0f && settings.inertia > 0.0f,
            "mass and inertia of the proxy must be positive");
    require(settings.substeps >= 1 && settings.max_substeps >= settings.substeps,
            "substeps must be at least 1 and at most max_substeps");
}

// Distances to a surface change by at most the motion, except for a core that emerges from the solid: behind
// its triangles there was no contact.
bool came_from_behind(const std::array<float, 3>& before, const std::array<float, 3>& after, float motion) {
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] - after[i] > motion) {
            return true;
        }
    }
    return false;
}

}  // namespace

RigidLayer::RigidLayer(const Laryngoscope& scope, const TriangleMesh& shell,
                       std::span<const Tissue> triangle_tissue, const Settings& settings) {
    check(scope, shell, triangle_tissue, settings);
    world_ = std::make_unique<World>(scope, shell, triangle_tissue, settings);
}

RigidLayer::~RigidLayer() = default;
RigidLayer::RigidLayer(RigidLayer&&) noexcept = default;
RigidLayer& RigidLayer::operator=(RigidLayer&&) noexcept = default;

void RigidLayer::move_shell(std::span<const Vec3f> vertices) {
    if (world_->shell_shape && vertices.size() == world_->vertices.size()) {
        world_->move_shell(vertices);
    }
}

void RigidLayer::reset(const RigidTransform& pose) {
    if (is_valid_pose(pose)) {
        world_->place(pose);
    }
}

const ProxyResult& RigidLayer::result() const {
    return world_->result;
}

const ProxyResult& RigidLayer::step(const RigidTransform& device_pose, float dt) {
    World& w = *world_;
    const RigidTransform start = w.device;
    const RigidTransform end = is_valid_pose(device_pose) ? device_pose : start;
    const Vec3f displacement = end.translation - start.translation;
    const Vec3f turn = rotation_vector(end.rotation * start.rotation.conjugate());
    const float reach = w.reach / to_cm;
    const float device_speed = (displacement.norm() + reach * turn.norm()) / dt;
    const bool jumped = device_speed > w.settings.device_speed_limit;
    w.device = end;
    w.device_velocity = jumped ? Vec3f::Zero() : Vec3f(displacement / dt);
    w.device_angular_velocity = jumped ? Vec3f::Zero() : Vec3f(turn / dt);

    ProxyResult& result = w.result;
    result.force.setZero();
    result.torque.setZero();
    result.contacts.clear();
    w.merge_keys.clear();
    result.dropped_contacts = 0;
    result.rolled_back = 0;
    w.solver.reset();

    const float proxy_speed = result.velocity.norm() + reach * result.angular_velocity.norm();
    const float fastest = jumped ? w.settings.device_speed_limit : std::max(device_speed, proxy_speed);
    const float allowed = motion_share * w.smallest_radius / to_cm;
    // 20 % more than the motion needs, so that the limit does not slow down a proxy that catches up.
    const int count = static_cast<int>(std::clamp(std::ceil(1.2f * fastest * dt / allowed),
                                                  static_cast<float>(w.settings.substeps),
                                                  static_cast<float>(w.settings.max_substeps)));
    const float substep = dt / static_cast<float>(count);
    result.substeps = count;

    // A shell that moved into the proxy, or a reset inside it, leaves contacts that no small motion can
    // satisfy. They are ignored until the proxy is free, wherever the coupling pulls it.
    w.embedded = false;
    w.gather_contacts();
    if (w.too_deep()) {
        w.embedded = true;
        w.gather_contacts();
    }
    for (int i = 1; i <= count; ++i) {
        const float share = static_cast<float>(i) / static_cast<float>(count);
        RigidTransform target = end;
        if (!jumped && i < count) {
            target = {(quaternion_from(share * turn) * start.rotation).normalized(),
                      start.translation + share * displacement};
        }
        const btTransform before = w.proxy->getWorldTransform();
        const std::array<float, 3> nearest = w.nearest();
        w.apply_coupling(target, substep);
        w.advance(substep);
        w.record_contacts(dt);
        w.gather_contacts();
        if (w.too_deep() &&
            came_from_behind(nearest, w.nearest(), 1.05f * motion_share * w.smallest_radius)) {
            w.embedded = true;
            w.gather_contacts();
        }
        if (w.too_deep()) {
            w.proxy->setWorldTransform(before);
            w.proxy->setLinearVelocity({0, 0, 0});
            w.proxy->setAngularVelocity({0, 0, 0});
            w.gather_contacts();
            ++result.rolled_back;
        }
        if (!w.embedded && w.depth() <= w.settings.penetration_tolerance * to_cm) {
            result.last_free = pose_of(w.proxy->getWorldTransform());
        }
    }
    result.pose = pose_of(w.proxy->getWorldTransform());
    result.velocity = from_bullet(w.proxy->getLinearVelocity()) / to_cm;
    result.angular_velocity = from_bullet(w.proxy->getAngularVelocity());
    result.penetration = w.depth() / to_cm;
    result.embedded = w.embedded;
    return result;
}

int library_version() {
    return BT_BULLET_VERSION;
}

}  // namespace eti::rigid
