// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/proxy_world.hpp"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

#include <algorithm>
#include <cmath>

#include "common/mesh/closest_point.hpp"

namespace eti::rigid {

btTransform bullet_pose(const RigidTransform& pose) {
    const Quatf q = pose.rotation.normalized();
    return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bullet(Vec3f(to_cm * pose.translation)));
}

RigidTransform pose_of(const btTransform& pose) {
    const btQuaternion q = pose.getRotation();
    return {Quatf(q.w(), q.x(), q.y(), q.z()).normalized(), from_bullet(pose.getOrigin()) / to_cm};
}

RigidLayer::World::World(const Laryngoscope& scope, const TriangleMesh& mesh,
                         std::span<const Tissue> triangle_tissue, const Settings& chosen)
    : settings(chosen),
      triangles(mesh.triangles),
      tissue(triangle_tissue.begin(), triangle_tissue.end()),
      topology(mesh.triangles, mesh.vertices.size()) {
    vertices.reserve(mesh.vertices.size());
    for (const Vec3f& vertex : mesh.vertices) {
        vertices.push_back(to_cm * vertex);
    }
    dispatcher.registerCollisionCreateFunc(COMPOUND_SHAPE_PROXYTYPE, TRIANGLE_MESH_SHAPE_PROXYTYPE, &create);
    dispatcher.registerCollisionCreateFunc(TRIANGLE_MESH_SHAPE_PROXYTYPE, COMPOUND_SHAPE_PROXYTYPE, &create);

    // No randomised order and no processor-dependent code path, so that results are bit-identical. The solver
    // returns impulses only in warm-starting mode; its contacts are always new, so nothing is warm-started.
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS;
    info.m_warmstartingFactor = 0.0f;
    info.m_numIterations = settings.solver_iterations;
    info.m_leastSquaresResidualThreshold =
        to_cm * settings.solver_residual * to_cm * settings.solver_residual;
    // Corrects depth without adding to the reported force. Of a compliant contact, depth is the force.
    info.m_splitImpulse = settings.contact_stiffness == 0.0f;
    info.m_splitImpulsePenetrationThreshold = 0.0f;
    info.m_erp2 = 0.4f;  // fraction of the depth corrected per substep
    info.m_splitImpulseTurnErp = 1.0f;
    world.getSimulationIslandManager()->setSplitIslands(false);
    world.setGravity({0, 0, 0});

    build_tool(scope);
    if (!triangles.empty()) {
        build_shell();
    }
    buffer.friction = settings.friction;
    buffer.stiffness = settings.contact_stiffness;
    buffer.damping = settings.contact_damping;
    buffer.proxy = proxy.get();
    place({});
}

RigidLayer::World::~World() {
    world.removeRigidBody(proxy.get());
    world.removeRigidBody(blade.get());
    if (shell) {
        world.removeRigidBody(shell.get());
    }
}

void RigidLayer::World::build_tool(const Laryngoscope& scope) {
    smallest_radius = to_cm * scope.capsules[0].radius;
    for (std::size_t i = 0; i < scope.capsules.size(); ++i) {
        const Capsule& source = scope.capsules[i];
        capsules[i] = {to_cm * source.a, to_cm * source.b, to_cm * source.radius};
        const Vec3f axis = capsules[i].b - capsules[i].a;
        capsule_shapes.push_back(std::make_unique<btCapsuleShape>(capsules[i].radius, axis.norm()));
        const Quatf turn = Quatf::FromTwoVectors(Vec3f::UnitY(), axis.norm() > 0.0f ? axis : Vec3f::UnitY());
        tool_shape.addChildShape(btTransform(btQuaternion(turn.x(), turn.y(), turn.z(), turn.w()),
                                             to_bullet(Vec3f(0.5f * (capsules[i].a + capsules[i].b)))),
                                 capsule_shapes.back().get());
        reach = std::max(
            {reach, capsules[i].a.norm() + capsules[i].radius, capsules[i].b.norm() + capsules[i].radius});
        smallest_radius = std::min(smallest_radius, capsules[i].radius);
    }
    const float inertia = settings.inertia * to_cm * to_cm;
    proxy = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(
        settings.mass, nullptr, &tool_shape, {inertia, inertia, inertia}));
    proxy->setDamping(0.0f, 0.0f);
    proxy->setFlags(0);
    proxy->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(proxy.get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::StaticFilter);

    blade =
        std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0.0f, nullptr, &tool_shape));
    blade->setCollisionFlags(blade->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    blade->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(blade.get(), btBroadphaseProxy::KinematicFilter, 0);
}

void RigidLayer::World::move_shell(std::span<const Vec3f> moved) {
    float farthest = 0.0f;
    for (std::size_t i = 0; i < moved.size(); ++i) {
        const Vec3f place = to_cm * moved[i];
        farthest = std::max(farthest, (place - vertices[i]).squaredNorm());
        vertices[i] = place;
    }
    travel += static_cast<double>(std::sqrt(farthest));
    if (travel - hierarchy_travel > double{hierarchy_slack}) {
        hierarchy_travel = travel;
        const auto [low, high] = bounds();
        shell_shape->refit(low, high);
        world.updateSingleAabb(shell.get());
    }
}

void RigidLayer::World::build_shell() {
    static_assert(sizeof(Triangle) == 3 * sizeof(int) && sizeof(Vec3f) == 3 * sizeof(btScalar));
    shell_mesh = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(triangles.size()), reinterpret_cast<int*>(triangles.data()),
        static_cast<int>(sizeof(Triangle)), static_cast<int>(vertices.size()), vertices[0].data(),
        static_cast<int>(sizeof(Vec3f)));
    const auto [low, high] = bounds();
    shell_shape = std::make_unique<ShellShape>(shell_mesh.get(), true, low, high);
    // Enlarges the broad phase's box, so that contacts before touch are found.
    shell_shape->setMargin(smallest_radius);
    shell = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0.0f, nullptr, shell_shape.get()));
    world.addRigidBody(shell.get(), btBroadphaseProxy::StaticFilter, btBroadphaseProxy::DefaultFilter);
}

std::pair<btVector3, btVector3> RigidLayer::World::bounds() const {
    Vec3f low = vertices[0];
    Vec3f high = vertices[0];
    for (const Vec3f& vertex : vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    // A flat shell has a box without volume, by which the quantised tree cannot divide.
    const Vec3f room = Vec3f::Constant(smallest_radius);
    return {to_bullet(Vec3f(low - room)), to_bullet(Vec3f(high + room))};
}

void RigidLayer::World::place(const RigidTransform& pose) {
    proxy->setWorldTransform(bullet_pose(pose));
    proxy->setInterpolationWorldTransform(proxy->getWorldTransform());
    proxy->setLinearVelocity({0, 0, 0});
    proxy->setAngularVelocity({0, 0, 0});
    blade->setWorldTransform(bullet_pose(pose));
    blade->setInterpolationWorldTransform(blade->getWorldTransform());
    device = pose;
    result = {};
    result.pose = pose;
    result.last_free = pose;
    embedded = false;
    gather_contacts();
    result.penetration = depth() / to_cm;
}

bool RigidLayer::World::may_touch(std::uint32_t triangle, const Capsule& capsule, float within) const {
    const auto& [a, b, c] = triangles[triangle];
    const Vec3f centroid = (vertices[a] + vertices[b] + vertices[c]) / 3.0f;
    const float extent =
        std::sqrt(std::max({(vertices[a] - centroid).squaredNorm(), (vertices[b] - centroid).squaredNorm(),
                            (vertices[c] - centroid).squaredNorm()}));
    const float limit = within + extent;
    return offset_from_segment(capsule.a, capsule.b, centroid).squaredNorm() <= limit * limit;
}

// The bounding box of a long oblique capsule contains many times the triangles near it; boxes of short pieces
// do not. Sorted, so that the order does not depend on the tree.
void RigidLayer::World::find_near(const Capsule& capsule, float within, std::vector<std::uint32_t>& found) {
    constexpr float piece_length = 2.0f;  // [cm]
    const Vec3f axis = capsule.b - capsule.a;
    struct Collector : btTriangleCallback {
        Collector(const World& in, const Capsule& around, float up_to, std::vector<std::uint32_t>& into)
            : world(in), capsule(around), reach(up_to), found(into) {}
        void processTriangle(btVector3*, int, int index) override {
            const auto triangle = static_cast<std::uint32_t>(index);
            if (world.may_touch(triangle, capsule, reach)) {
                found.push_back(triangle);
            }
        }
        const World& world;
        const Capsule& capsule;
        float reach;
        std::vector<std::uint32_t>& found;
    } collector(*this, capsule, within, found);
    found.clear();
    const int pieces = std::max(1, static_cast<int>(std::ceil(axis.norm() / piece_length)));
    const Vec3f room = Vec3f::Constant(within + hierarchy_slack);
    for (int i = 0; i < pieces; ++i) {
        const Vec3f from = capsule.a + static_cast<float>(i) / static_cast<float>(pieces) * axis;
        const Vec3f to = capsule.a + static_cast<float>(i + 1) / static_cast<float>(pieces) * axis;
        const Vec3f low = from.cwiseMin(to) - room;
        const Vec3f high = from.cwiseMax(to) + room;
        shell_shape->processAllTriangles(&collector, to_bullet(low), to_bullet(high));
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

void RigidLayer::World::find_triangles(std::size_t number, const Capsule& capsule, float margin) {
    Surroundings& about = surroundings[number];
    const float gone = std::max((capsule.a - about.a).norm(), (capsule.b - about.b).norm());
    if (!about.known || !(double{gone} + travel - about.travel <= double{surroundings_slack})) {
        about.a = capsule.a;
        about.b = capsule.b;
        about.travel = travel;
        about.known = true;
        find_near(capsule, capsule.radius + margin + surroundings_slack, about.triangles);
    }
    nearby.clear();
    for (const std::uint32_t triangle : about.triangles) {
        if (may_touch(triangle, capsule, capsule.radius + margin)) {
            nearby.push_back(triangle);
        }
    }
}

void RigidLayer::World::gather_contacts() {
    const btTransform& pose = proxy->getWorldTransform();
    buffer.origin = pose.getOrigin();
    buffer.contacts.clear();
    if (!shell_shape) {
        return;
    }
    const float margin = motion_share * smallest_radius;
    const MeshView mesh{vertices, triangles, topology};
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        const Capsule capsule{from_bullet(pose * to_bullet(capsules[i].a)),
                              from_bullet(pose * to_bullet(capsules[i].b)), capsules[i].radius};
        find_triangles(i, capsule, margin);
        for (const std::uint32_t triangle : nearby) {
            append_contacts(capsule, i, triangle, mesh, margin, buffer.contacts);
        }
    }
    if (embedded) {
        std::erase_if(buffer.contacts, [this](const CapsuleContact& contact) {
            return contact.distance < -depth_share * smallest_radius;
        });
    }
    const std::size_t bound = static_cast<std::size_t>(settings.max_contacts);
    if (buffer.contacts.size() > bound) {
        std::stable_sort(
            buffer.contacts.begin(), buffer.contacts.end(),
            [](const CapsuleContact& a, const CapsuleContact& b) { return a.distance < b.distance; });
        result.dropped_contacts += static_cast<std::uint32_t>(buffer.contacts.size() - bound);
        buffer.contacts.resize(bound);
    }
}

float RigidLayer::World::depth() const {
    float deepest = 0.0f;
    for (const CapsuleContact& contact : buffer.contacts) {
        deepest = std::max(deepest, -contact.distance);
    }
    return deepest;
}

std::array<float, 3> RigidLayer::World::nearest() const {
    std::array<float, 3> distance;
    distance.fill(motion_share * smallest_radius);
    for (const CapsuleContact& contact : buffer.contacts) {
        distance[contact.capsule] = std::min(distance[contact.capsule], contact.distance);
    }
    return distance;
}

float RigidLayer::World::farthest_move(const btTransform& before, const btTransform& after) const {
    float farthest = 0.0f;
    for (const Capsule& capsule : capsules) {
        for (const Vec3f& end : {capsule.a, capsule.b}) {
            const btVector3 point = to_bullet(end);
            farthest = std::max(farthest, (after * point - before * point).length());
        }
    }
    return farthest;
}

// Virtual coupling, implicit in time. With target x_d at the substep's end and velocity v_d,
//     m (v' - v) = dt (k (x_d - x - dt v') + c (v_d - v') + f_contact)
// equals a body of mass m + dt c + dt^2 k under the force k (x_d - x - dt v) + c (v_d - v). With that mass
// the contact solver includes the coupling's resistance: a pressed proxy at rest carries exactly k (x_d - x),
// and any stiffness is stable. The same holds for rotation.
void RigidLayer::World::apply_coupling(const RigidTransform& target, float dt) {
    const RigidTransform pose = pose_of(proxy->getWorldTransform());
    Vec3f velocity = from_bullet(proxy->getLinearVelocity()) / to_cm;
    Vec3f angular = from_bullet(proxy->getAngularVelocity());

    const auto pull = [dt](const Vec3f& offset, const Vec3f& speed, const Vec3f& target_speed, float own,
                           float k, float c, float limit, float& effective) {
        Vec3f spring = k * (offset - dt * speed);
        effective = own + dt * c + dt * dt * k;
        if (const float size = spring.norm(); size > limit) {
            spring *= limit / size;
            effective = own + dt * c;
        }
        return Vec3f(speed + dt * (spring + c * (target_speed - speed)) / effective);
    };
    float mass = 0.0f;
    float inertia = 0.0f;
    velocity = pull(target.translation - pose.translation, velocity, device_velocity, settings.mass,
                    settings.stiffness, settings.damping, settings.force_limit, mass);
    angular = pull(rotation_vector(target.rotation * pose.rotation.conjugate()), angular,
                   device_angular_velocity, settings.inertia, settings.rotational_stiffness,
                   settings.rotational_damping, settings.torque_limit, inertia);

    const float motion = dt * (to_cm * velocity.norm() + reach * angular.norm());
    if (const float allowed = motion_share * smallest_radius; motion > allowed) {
        velocity *= allowed / motion;
        angular *= allowed / motion;
    }
    const float inertia_cm = inertia * to_cm * to_cm;
    proxy->setMassProps(mass, {inertia_cm, inertia_cm, inertia_cm});
    proxy->updateInertiaTensor();
    proxy->setLinearVelocity(to_bullet(Vec3f(to_cm * velocity)));
    proxy->setAngularVelocity(to_bullet(angular));
    blade->setWorldTransform(bullet_pose(target));
}

void RigidLayer::World::advance(float dt) {
    const btTransform before = proxy->getWorldTransform();
    world.stepSimulation(dt, 0);
    buffer.read_impulses();

    // Contacts can turn translation into rotation and thus speed up one end of the tool.
    const float allowed = motion_share * smallest_radius;
    if (const float moved = farthest_move(before, proxy->getWorldTransform()); moved > allowed) {
        const btTransform after = proxy->getWorldTransform();
        const float share = allowed / moved;
        proxy->setWorldTransform(btTransform(before.getRotation().slerp(after.getRotation(), share),
                                             before.getOrigin().lerp(after.getOrigin(), share)));
        proxy->setLinearVelocity(share * proxy->getLinearVelocity());
        proxy->setAngularVelocity(share * proxy->getAngularVelocity());
    }
}

void RigidLayer::World::record_contacts(float step_dt) {
    const float to_newton = 1.0f / (to_cm * step_dt);
    for (std::size_t i = 0; i < buffer.contacts.size(); ++i) {
        const CapsuleContact& found = buffer.contacts[i];
        const ContactBuffer::Impulse& impulse = buffer.impulses[i];
        result.force += to_newton * from_bullet(impulse.total);
        result.torque += (to_newton / to_cm) * from_bullet(impulse.arm.cross(impulse.total));
        const float force = to_newton * impulse.normal;
        if (force <= 0.0f) {
            continue;
        }
        std::size_t slot = 0;
        while (slot < merge_keys.size() &&
               !(merge_keys[slot] == found.capsule && result.contacts[slot].triangle == found.triangle &&
                 (result.contacts[slot].position - found.point / to_cm).norm() < 1e-3f)) {
            ++slot;
        }
        if (slot == merge_keys.size()) {
            merge_keys.push_back(found.capsule);
            result.contacts.push_back(
                {found.point / to_cm, found.normal, 0.0f, tissue[found.triangle], found.triangle});
        }
        Contact& contact = result.contacts[slot];
        const float share = force / (contact.force + force);
        contact.position += share * (found.point / to_cm - contact.position);
        contact.normal = ((1.0f - share) * contact.normal + share * found.normal).normalized();
        contact.force += force;
    }
}

}  // namespace eti::rigid
