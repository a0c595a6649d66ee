// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/coupling.hpp"

namespace eti {

namespace {

Vec3f shortened(const Vec3f& v, float most) {
    const float length = v.norm();
    return length > most ? Vec3f(v * (most / length)) : v;
}

}  // namespace

Wrench coupling_wrench(const Motion& device, const Motion& proxy, const CouplingSettings& settings) {
    const Vec3f turn = rotation_vector(proxy.pose.rotation * device.pose.rotation.conjugate());
    return {settings.stiffness * (proxy.pose.translation - device.pose.translation) +
                settings.damping * (proxy.velocity - device.velocity),
            settings.rotational_stiffness * turn +
                settings.rotational_damping * (proxy.angular_velocity - device.angular_velocity)};
}

Wrench clamp_to_limits(const Wrench& wrench, const CouplingSettings& settings) {
    if (!wrench.is_finite()) {
        return {};
    }
    return {shortened(wrench.force, settings.force_limit), shortened(wrench.torque, settings.torque_limit)};
}

}  // namespace eti
