// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::rigid {

/// Virtual coupling between device and proxy, and the limits of one step.
struct Settings {
    float mass = 0.1f;                   ///< [kg], of the proxy
    float inertia = 1e-4f;               ///< [kg m^2], isotropic, about the tool's origin
    float stiffness = 2000.0f;           ///< [N/m], at the tool's origin
    float damping = 28.0f;               ///< [N s/m]; 2 sqrt(stiffness * mass) is critical
    float rotational_stiffness = 20.0f;  ///< [N m/rad]; 2000 N/m at 0.1 m from the origin
    float rotational_damping = 0.09f;    ///< [N m s/rad]; 2 sqrt(rotational_stiffness * inertia) is critical
    float force_limit = 60.0f;           ///< [N], of the coupling spring
    float torque_limit = 3.0f;           ///< [N m], of the coupling spring
    /// [m/s] at any point of the tool. A faster device is taken to have jumped; the proxy then follows as
    /// fast as the limits above allow. Hands reach about 1 m/s.
    float device_speed_limit = 3.0f;
    float friction = 0.1f;  ///< Coulomb coefficient; wet mucosa on steel
    int substeps = 6;       ///< per step at rest; fast motion needs more
    int max_substeps = 24;  ///< upper limit; beyond it the proxy lags rather than move farther per substep
    /// Upper limit per substep. Where the blade acts as a lever its contacts are coupled: with arms of 56 and
    /// 84 mm one iteration leaves 97 % of the error, and 40 iterations left a tenth of the force.
    int solver_iterations = 400;
    /// [m/s]; iteration ends once no contact's speed changes by more.
    float solver_residual = 1e-5f;
    float penetration_tolerance = 0.1e-3f;  ///< [m]; a pose deeper than this counts as penetrating
    /// [N/m] and [N s/m], of a contact: mucosa on bone. 0: rigid. A blade between bones that close on it
    /// needs a finite one, because no rigid contact force would satisfy both.
    float contact_stiffness = 0.0f;
    float contact_damping = 0.0f;
    int max_contacts = 128;  ///< nearest contacts kept per substep; dropped ones are counted
};

/// Contact of the laryngoscope's proxy with the shell.
struct Contact {
    Vec3f position = Vec3f::Zero();  ///< [m], on the shell
    Vec3f normal = Vec3f::UnitZ();   ///< unit, from the shell to the proxy
    float force = 0.0f;              ///< [N], along the normal, step mean
    Tissue tissue = Tissue::soft;
    std::uint32_t triangle = 0;  ///< of the shell
};

struct ProxyResult {
    RigidTransform pose;
    Vec3f velocity = Vec3f::Zero();          ///< [m/s], of the tool's origin
    Vec3f angular_velocity = Vec3f::Zero();  ///< [rad/s]
    RigidTransform last_free;                ///< latest pose without penetration
    float penetration = 0.0f;                ///< [m], maximum at `pose`; 0 without penetration
    Vec3f force = Vec3f::Zero();             ///< [N], of the shell on the proxy, friction included, step mean
    Vec3f torque = Vec3f::Zero();            ///< [N m], about the proxy's origin
    std::vector<Contact> contacts;           ///< contacts that carried force
    std::uint32_t dropped_contacts = 0;      ///< contacts beyond Settings::max_contacts in this step
    int substeps = 0;                        ///< taken in this step
    bool embedded = false;  ///< deeper in the shell than contacts can resolve; moves without contact
    int rolled_back = 0;    ///< substeps undone because they ended too deep in the shell
};

/// The laryngoscope's dynamic proxy against the shell, on Bullet. Patient frame, SI.
///
/// The shell's triangles face the free side and stop the proxy from that side only. Each capsule of the proxy
/// has a core segment. No point of the tool moves more than half the smallest radius per substep, and
/// contacts act before touch, so that a core never crosses a triangle.
///
/// The proxy's motion is the only state kept between steps: equal inputs give bit-identical results.
class RigidLayer {
  public:
    /// `triangle_tissue` has one entry per triangle. An empty shell has no contacts. Throws
    /// std::invalid_argument on a malformed mesh, tool or setting.
    RigidLayer(const Laryngoscope& scope, const TriangleMesh& shell, std::span<const Tissue> triangle_tissue,
               const Settings& settings = {});
    ~RigidLayer();
    RigidLayer(RigidLayer&&) noexcept;
    RigidLayer& operator=(RigidLayer&&) noexcept;

    /// Sets the positions [m] of all shell vertices. The shell must move less per step than the proxy's
    /// radius; after a larger move call reset().
    void move_shell(std::span<const Vec3f> vertices);

    /// Places proxy and device at `pose`, at rest.
    void reset(const RigidTransform& pose);

    /// Advances by `dt` [s], in which the device moves from its last pose to `device_pose`. The result is
    /// valid until the next call. A non-finite pose is replaced by the last one.
    const ProxyResult& step(const RigidTransform& device_pose, float dt);

    [[nodiscard]] const ProxyResult& result() const;

  private:
    struct World;
    std::unique_ptr<World> world_;
};

/// Version of Bullet, e.g. 324 for 3.24.
[[nodiscard]] int library_version();

}  // namespace eti::rigid
