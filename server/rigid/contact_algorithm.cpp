// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/contact_algorithm.hpp"

#include <new>

namespace eti::rigid {

void ContactBuffer::read_impulses() {
    impulses.assign(contacts.size(), {});
    std::size_t next = 0;
    for (const btPersistentManifold* manifold : manifolds) {
        for (int i = 0; i < manifold->getNumContacts(); ++i, ++next) {
            const btManifoldPoint& point = manifold->getContactPoint(i);
            Impulse& impulse = impulses[next];
            impulse.normal = point.m_appliedImpulse;
            impulse.total = point.m_appliedImpulse * point.m_normalWorldOnB +
                            point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                            point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
            impulse.arm = point.m_positionWorldOnA - origin;
        }
    }
}

ProxyShellAlgorithm::~ProxyShellAlgorithm() {
    release_manifolds();
}

void ProxyShellAlgorithm::release_manifolds() {
    for (btPersistentManifold* manifold : buffer_.manifolds) {
        m_dispatcher->releaseManifold(manifold);
    }
    buffer_.manifolds.clear();
}

void ProxyShellAlgorithm::processCollision(const btCollisionObjectWrapper* first,
                                           const btCollisionObjectWrapper* second, const btDispatcherInfo&,
                                           btManifoldResult*) {
    release_manifolds();
    const bool proxy_first = first->getCollisionObject() == buffer_.proxy;
    const btCollisionObject* proxy = (proxy_first ? first : second)->getCollisionObject();
    const btCollisionObject* shell = (proxy_first ? second : first)->getCollisionObject();
    const btTransform to_proxy = proxy->getWorldTransform().inverse();
    for (const CapsuleContact& contact : buffer_.contacts) {
        if (buffer_.manifolds.empty() || buffer_.manifolds.back()->getNumContacts() == MANIFOLD_CACHE_SIZE) {
            buffer_.manifolds.push_back(m_dispatcher->getNewManifold(proxy, shell));
        }
        const btVector3 on_shell = to_bullet(contact.point);
        const btVector3 normal = to_bullet(contact.normal);
        const btVector3 on_proxy = on_shell + contact.distance * normal;
        btManifoldPoint point(to_proxy * on_proxy, on_shell, normal, contact.distance);
        point.m_positionWorldOnA = on_proxy;
        point.m_positionWorldOnB = on_shell;
        point.m_combinedFriction = buffer_.friction;
        if (buffer_.stiffness > 0.0f) {
            point.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
            point.m_combinedContactStiffness1 = buffer_.stiffness;
            point.m_combinedContactDamping1 = buffer_.damping;
        }
        // The distance is positive before touch; the manifold must keep the contact.
        buffer_.manifolds.back()->setContactBreakingThreshold(BT_LARGE_FLOAT);
        buffer_.manifolds.back()->addManifoldPoint(point);
    }
}

btScalar ProxyShellAlgorithm::calculateTimeOfImpact(btCollisionObject*, btCollisionObject*,
                                                    const btDispatcherInfo&, btManifoldResult*) {
    return 1.0f;
}

void ProxyShellAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
    for (btPersistentManifold* manifold : buffer_.manifolds) {
        manifolds.push_back(manifold);
    }
}

btCollisionAlgorithm* ProxyShellAlgorithm::Create::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper*,
    const btCollisionObjectWrapper*) {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(ProxyShellAlgorithm));
    return new (memory) ProxyShellAlgorithm(info, buffer);
}

}  // namespace eti::rigid
