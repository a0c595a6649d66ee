// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools.hpp"

namespace eti::rigid {

/// The virtual coupling that pulls the proxy to the device, and the bounds of one step.
struct Settings {
    float mass = 0.1f;                   ///< [kg], proxy
    float inertia = 1e-4f;               ///< [kg m^2], isotropic, about the tool's origin
    float stiffness = 2000.0f;           ///< [N/m], at the tool's origin
    float damping = 28.0f;               ///< [N s/m]; 2 sqrt(stiffness * mass) is critical
    float rotational_stiffness = 20.0f;  ///< [N m/rad]; 2000 N/m at 0.1 m from the origin
    float rotational_damping = 0.09f;    ///< [N m s/rad]; 2 sqrt(rotational_stiffness * inertia) is critical
    float force_limit = 60.0f;           ///< [N], of the coupling's spring
    float torque_limit = 3.0f;           ///< [N m], of the coupling's spring
    /// [m/s] at any point of the tool; a device faster than this has jumped, and the proxy follows
    /// at the pace that the limits above allow. Hands reach about 1 m/s.
    float device_speed_limit = 3.0f;
    float friction = 0.1f;  ///< Coulomb coefficient; wet mucosa on steel
    int substeps = 6;       ///< per step at rest; fast motion takes more
    int max_substeps = 24;  ///< beyond it the proxy lags instead of moving farther per substep
    /// Per substep, at most. Where the blade is a lever its contacts answer to each other: with arms of 56
    /// and 84 mm an iteration leaves 97 % of the error, and 40 left a tenth of the force.
    int solver_iterations = 400;
    /// [m/s]; iterations end once they change no contact's speed by more.
    float solver_residual = 1e-5f;
    float penetration_tolerance = 0.1e-3f;  ///< [m], a pose deeper than this counts as penetrating
    int max_contacts = 128;                 ///< kept per substep, the nearest; the others are counted
};

struct Contact {
    Vec3f position = Vec3f::Zero();  ///< [m], on the shell
    Vec3f normal = Vec3f::UnitZ();   ///< unit, from the shell to the proxy
    float force = 0.0f;              ///< [N], along the normal, mean over the step
    Tissue tissue = Tissue::soft;
    std::uint32_t triangle = 0;  ///< of the shell
};

struct ProxyResult {
    RigidTransform pose;
    Vec3f velocity = Vec3f::Zero();          ///< [m/s], of the tool's origin
    Vec3f angular_velocity = Vec3f::Zero();  ///< [rad/s]
    RigidTransform last_free;                ///< last pose that did not penetrate
    float penetration = 0.0f;                ///< [m], deepest, at `pose`; 0 when clear of the shell
    Vec3f force = Vec3f::Zero();             ///< [N], shell on proxy, friction included, mean over the step
    Vec3f torque = Vec3f::Zero();            ///< [N m], about the proxy's origin
    std::vector<Contact> contacts;           ///< those that carried force
    std::uint32_t dropped_contacts = 0;      ///< beyond Settings::max_contacts, in this step
    int substeps = 0;                        ///< taken in this step
    bool embedded = false;  ///< found deeper in the shell than it can push back; passes freely
    int rolled_back = 0;    ///< substeps undone because they ended too deep in the shell
};

struct RayHit {
    Vec3f position = Vec3f::Zero();  ///< [m]
    Vec3f normal = Vec3f::UnitZ();   ///< unit, towards the ray's origin
    float distance = 0.0f;           ///< [m], from the ray's origin
    std::uint32_t triangle = 0;
    Tissue tissue = Tissue::soft;
};

/// The laryngoscope's dynamic proxy against the shell, on Bullet. Patient frame, SI.
///
/// The shell's triangles face the free side and stop the proxy from that side only. The proxy's
/// capsules have a core segment each; no point of the tool moves farther in a substep than half the
/// smallest radius, and contacts act before they touch, so that a core never crosses a triangle.
///
/// Nothing is kept between steps but the proxy's motion: same inputs, same bits.
class RigidLayer {
  public:
    /// `triangle_tissue` has one entry per triangle. An empty shell stops nothing.
    /// Throws std::invalid_argument on a malformed mesh, tool or setting.
    RigidLayer(const Laryngoscope& scope, const TriangleMesh& shell, std::span<const Tissue> triangle_tissue,
               const Settings& settings = {});
    ~RigidLayer();
    RigidLayer(RigidLayer&&) noexcept;
    RigidLayer& operator=(RigidLayer&&) noexcept;

    /// New positions [m] of all shell vertices. The shell must move less per step than the proxy's
    /// radius; after a larger move call reset().
    void move_shell(std::span<const Vec3f> vertices);

    /// Puts proxy and device at `pose`, at rest.
    void reset(const RigidTransform& pose);

    /// Advances by `dt` [s]; the device moves from its last pose to `device_pose` meanwhile.
    /// The result stays valid until the next call. A pose that is not finite is replaced by the last.
    const ProxyResult& step(const RigidTransform& device_pose, float dt);

    [[nodiscard]] const ProxyResult& result() const;

    /// First triangle, of either side, on the way from `from` to `to` [m].
    [[nodiscard]] std::optional<RayHit> ray(const Vec3f& from, const Vec3f& to) const;

  private:
    struct World;
    std::unique_ptr<World> world_;
};

/// Of the library behind it, e.g. 324 for 3.24.
[[nodiscard]] int library_version();

}  // namespace eti::rigid
