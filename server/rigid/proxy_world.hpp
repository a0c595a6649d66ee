// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <btBulletDynamicsCommon.h>

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "server/rigid/capsule_contacts.hpp"
#include "server/rigid/contact_algorithm.hpp"
#include "server/rigid/rigid_layer.hpp"

namespace eti::rigid {

// Bullet is tuned for objects of 0.05 to 10 units: its world is in centimetres.
inline constexpr float to_cm = 100.0f;

// Fraction of the smallest radius that any point of the tool may move per substep. A core keeps half its
// radius from every triangle (deeper substeps are rolled back), so it cannot reach one.
inline constexpr float motion_share = 0.45f;
inline constexpr float depth_share = 0.5f;

/// Conversion of a pose to Bullet's world and back to SI.
[[nodiscard]] btTransform bullet_pose(const RigidTransform& pose);
[[nodiscard]] RigidTransform pose_of(const btTransform& pose);

/// The shell's triangles in a bounding volume hierarchy.
class ShellShape : public btBvhTriangleMeshShape {
  public:
    using btBvhTriangleMeshShape::btBvhTriangleMeshShape;

    /// Refits the hierarchy after the vertices moved; `low` and `high` bound them, margin included. Bullet's
    /// refitTree() would find that box in six passes over all triangles, which take several times as long as
    /// the refit.
    void refit(const btVector3& low, const btVector3& high) {
        getOptimizedBvh()->refit(getMeshInterface(), low, high);
        m_localAabbMin = low;
        m_localAabbMax = high;
    }
};

/// Bullet's world of the rigid layer: shell, kinematic blade, proxy.
struct RigidLayer::World {
    World(const Laryngoscope& scope, const TriangleMesh& mesh, std::span<const Tissue> triangle_tissue,
          const Settings& chosen);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    void build_tool(const Laryngoscope& scope);
    void build_shell();
    /// Moves the shell; `moved` [vertices][m]. The hierarchy follows when it must.
    void move_shell(std::span<const Vec3f> moved);
    void place(const RigidTransform& pose);
    void gather_contacts();
    void apply_coupling(const RigidTransform& target, float dt);
    void advance(float dt);
    void record_contacts(float step_dt);
    [[nodiscard]] std::pair<btVector3, btVector3> bounds() const;
    /// Whether a triangle may come within `within` [cm] of the capsule's axis.
    [[nodiscard]] bool may_touch(std::uint32_t triangle, const Capsule& capsule, float within) const;
    void find_near(const Capsule& capsule, float within, std::vector<std::uint32_t>& found);
    /// Fills `nearby` for capsule `number` at its current pose.
    void find_triangles(std::size_t number, const Capsule& capsule, float margin);
    [[nodiscard]] float depth() const;
    [[nodiscard]] bool too_deep() const { return depth() > depth_share * smallest_radius; }
    /// Smallest contact distance [cm] of each capsule; the margin for a capsule without contacts.
    [[nodiscard]] std::array<float, 3> nearest() const;
    [[nodiscard]] float farthest_move(const btTransform& before, const btTransform& after) const;

    Settings settings;
    std::array<Capsule, 3> capsules;  // [cm], tool frame
    float reach = 0.0f;               // [cm], greatest distance of a point of the tool from its origin
    float smallest_radius = 0.0f;     // [cm]
    std::vector<Vec3f> vertices;      // [cm]
    std::vector<Triangle> triangles;
    std::vector<Tissue> tissue;
    MeshTopology topology;
    ContactBuffer buffer;

    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    ProxyShellAlgorithm::Create create{buffer};

    btCompoundShape tool_shape;
    std::vector<std::unique_ptr<btCapsuleShape>> capsule_shapes;
    std::unique_ptr<btRigidBody> proxy;
    std::unique_ptr<btRigidBody> blade;  // kinematic, at the device's pose; has no collisions
    std::unique_ptr<btTriangleIndexVertexArray> shell_mesh;
    std::unique_ptr<ShellShape> shell_shape;
    std::unique_ptr<btRigidBody> shell;

    RigidTransform device;
    Vec3f device_velocity = Vec3f::Zero();          // [m/s]
    Vec3f device_angular_velocity = Vec3f::Zero();  // [rad/s]
    ProxyResult result;
    std::vector<std::uint32_t> nearby;  // candidate triangles of a capsule
    /// Candidate triangles of a capsule, valid while its ends and the shell have together moved by at most
    /// surroundings_slack from these.
    struct Surroundings {
        bool known = false;
        Vec3f a = Vec3f::Zero(), b = Vec3f::Zero();  // [cm]
        double travel = 0.0;                         // [cm], the shell's
        std::vector<std::uint32_t> triangles;
    };
    static constexpr float surroundings_slack = 0.15f;  // [cm]
    static constexpr float hierarchy_slack = 0.05f;     // [cm], by which the shell may leave its hierarchy
    double travel = 0.0;  // [cm], sum of the greatest distances of a vertex in all moves
    double hierarchy_travel = 0.0;
    std::array<Surroundings, 3> surroundings;
    bool embedded = false;                  // the step began deeper in the shell than contacts can resolve
    std::vector<std::uint32_t> merge_keys;  // capsule index of each entry of result.contacts
};

}  // namespace eti::rigid
