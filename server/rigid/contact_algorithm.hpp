// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <btBulletCollisionCommon.h>

#include <vector>

#include "server/rigid/capsule_contacts.hpp"

namespace eti::rigid {

[[nodiscard]] inline btVector3 to_bullet(const Vec3f& v) {
    return {v.x(), v.y(), v.z()};
}
[[nodiscard]] inline Vec3f from_bullet(const btVector3& v) {
    return {v.x(), v.y(), v.z()};
}

/// Contacts of the proxy for one substep, in Bullet's world (centimetres), and the solver's impulses.
struct ContactBuffer {
    struct Impulse {
        btVector3 arm;     ///< [cm], from the proxy's origin to the point of application
        btVector3 total;   ///< [kg cm/s], on the proxy, friction included
        float normal = 0;  ///< [kg cm/s], along the contact normal
    };
    std::vector<CapsuleContact> contacts;
    std::vector<Impulse> impulses;  ///< one per contact, after the substep
    std::vector<Capsule> capsules;  ///< [cm], world frame, at the substep's start
    btVector3 origin{0, 0, 0};      ///< [cm], the proxy's origin at the substep's start
    float friction = 0.0f;
    float stiffness = 0.0f;  ///< [N/m]; 0: rigid
    float damping = 0.0f;    ///< [N s/m]
    const btCollisionObject* proxy = nullptr;
    std::vector<btPersistentManifold*> manifolds;

    /// Reads the solver's applied impulses into `impulses`.
    void read_impulses();
};

/// Narrow phase for the proxy against the shell. Bullet's own keeps four points per capsule, carries them
/// over between steps and reports internal edges. This one passes every contact of the buffer to the solver,
/// in as many manifolds as needed, and nothing from earlier steps.
class ProxyShellAlgorithm : public btCollisionAlgorithm {
  public:
    ProxyShellAlgorithm(const btCollisionAlgorithmConstructionInfo& info, ContactBuffer& buffer)
        : btCollisionAlgorithm(info), buffer_(buffer) {}
    ~ProxyShellAlgorithm() override;
    ProxyShellAlgorithm(const ProxyShellAlgorithm&) = delete;
    ProxyShellAlgorithm& operator=(const ProxyShellAlgorithm&) = delete;

    void processCollision(const btCollisionObjectWrapper* first, const btCollisionObjectWrapper* second,
                          const btDispatcherInfo& info, btManifoldResult* result) override;
    btScalar calculateTimeOfImpact(btCollisionObject* first, btCollisionObject* second,
                                   const btDispatcherInfo& info, btManifoldResult* result) override;
    void getAllContactManifolds(btManifoldArray& manifolds) override;

    struct Create : btCollisionAlgorithmCreateFunc {
        explicit Create(ContactBuffer& to_fill) : buffer(to_fill) {}
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* first,
                                                       const btCollisionObjectWrapper* second) override;
        ContactBuffer& buffer;
    };

  private:
    void release_manifolds();

    ContactBuffer& buffer_;
};

}  // namespace eti::rigid
