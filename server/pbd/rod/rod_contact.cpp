// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod_contact.hpp"

#include <algorithm>

namespace eti::pbd {
namespace {

/// Force at the current pose, and its negative derivative by the point's displacement.
struct Law {
    Vec3d force = Vec3d::Zero();      ///< [N]
    Mat3d stiffness = Mat3d::Zero();  ///< [N/m]
};

/// Stiffness [N/m] of a spring of `stiffness` in series with the obstacle's compliance.
double in_series(double stiffness, const RodContact& contact) {
    return stiffness / (1.0 + stiffness * double{contact.compliance});
}

Law linearise(const RodContact& contact, double grip) {
    const Vec3d normal = contact.normal.cast<double>();
    const Mat3d along = normal * normal.transpose();
    const double k = in_series(double{contact.stiffness}, contact);
    const Vec3d last = contact.force.cast<double>();
    Law law{-k * double{contact.gap} * normal, k * along};
    const double pressing = last.dot(normal);
    if (pressing > 0.0 && contact.friction.static_coefficient > 0.0f) {
        const Mat3d across = Mat3d::Identity() - along;
        const double hold = in_series(grip, contact);
        const Vec3d wanted = across * (last - hold * contact.slip.cast<double>());
        const double share = contact.friction.share(wanted.norm(), pressing);
        law.force += share * wanted;
        if (share == 1.0) {
            law.stiffness += hold * across;
        }
    }
    return law;
}

}  // namespace

bool is_active(const RodContact& contact) {
    if (contact.gap >= 0.0f && contact.force.isZero(0.0f)) {
        return false;
    }
    return in_series(double{contact.stiffness}, contact) * double{contact.gap} <
           double{std::max(0.0f, contact.force.dot(contact.normal))};
}

void add_contact(const RodContact& contact, const Vec3d& arm, double grip, double dt,
                 RodContactSystem& system) {
    const Law law = linearise(contact, grip);
    const Mat3d stiffness = dt * dt * (law.stiffness + contact.geometric_stiffness.cast<double>());
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
    const Vec3d displacement = motion.head<3>() + Vec3d(motion.tail<3>()).cross(arm);
    const Vec3d force = law.force - law.stiffness * displacement;
    const Vec3d normal = contact.normal.cast<double>();
    const double pressing = force.dot(normal);
    if (pressing <= 0.0) {
        return Vec3f::Zero();
    }
    const Vec3d across = force - pressing * normal;
    return (pressing * normal + contact.friction.share(across.norm(), pressing) * across).cast<float>();
}

}  // namespace eti::pbd
