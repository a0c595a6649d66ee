// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod_contact.hpp"

#include <algorithm>

namespace eti::pbd {
namespace {

/// Force at the present pose and how it falls with the point's displacement.
struct Law {
    Vec3d force = Vec3d::Zero();      ///< [N]
    Mat3d stiffness = Mat3d::Zero();  ///< [N/m]
};

Law linearise(const RodContact& contact, double grip) {
    const Vec3d normal = contact.normal.cast<double>();
    const Mat3d along = normal * normal.transpose();
    const double k = double{contact.stiffness};
    const Vec3d last = contact.force.cast<double>();
    Law law{-k * double{contact.gap} * normal, k * along};
    const double bound = double{contact.friction} * std::max(0.0, last.dot(normal));
    if (bound > 0.0) {
        const Mat3d across = Mat3d::Identity() - along;
        const Vec3d wanted = across * (last - grip * contact.slip.cast<double>());
        const double size = wanted.norm();
        if (size <= bound) {
            law.force += wanted;
            law.stiffness += grip * across;
        } else {
            law.force += wanted * (bound / size);
        }
    }
    return law;
}

}  // namespace

bool acts(const RodContact& contact) {
    return contact.stiffness * contact.gap < std::max(0.0f, contact.force.dot(contact.normal));
}

void add_contact(const RodContact& contact, const Vec3d& arm, double grip, double dt,
                 RodContactSystem& system) {
    const Law law = linearise(contact, grip);
    const Mat3d stiffness = dt * dt * law.stiffness;
    const Vec3d impulse = dt * dt * law.force;
    const Mat3d cross = cross_matrix(arm);
    // The point moves by shift + turn x arm = shift - [arm] turn.
    const Mat3d crossed = cross * stiffness;
    system.mass.topLeftCorner<3, 3>() += stiffness;
    system.mass.bottomLeftCorner<3, 3>() += crossed;
    system.mass.topRightCorner<3, 3>() += crossed.transpose();
    system.mass.bottomRightCorner<3, 3>() -= crossed * cross;
    system.impulse.head<3>() += impulse;
    system.impulse.tail<3>() += arm.cross(impulse);
}

Vec3f contact_force(const RodContact& contact, const Vec3d& arm, double grip, const Vec6d& motion) {
    const Law law = linearise(contact, grip);
    const Vec3d way = motion.head<3>() + Vec3d(motion.tail<3>()).cross(arm);
    const Vec3d force = law.force - law.stiffness * way;
    const Vec3d normal = contact.normal.cast<double>();
    const double pressing = force.dot(normal);
    if (pressing <= 0.0) {
        return Vec3f::Zero();
    }
    const Vec3d across = force - pressing * normal;
    const double size = across.norm();
    const double bound = double{contact.friction} * pressing;
    const double share = size > bound ? bound / size : 1.0;
    return (pressing * normal + share * across).cast<float>();
}

}  // namespace eti::pbd
