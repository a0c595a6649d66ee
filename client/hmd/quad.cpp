// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/quad.hpp"

namespace eti::hmd {

std::optional<QuadHit> intersect_quad(const Quad& panel, const RigidTransform& aim) {
    constexpr float least = 1e-3f;  // rays nearly parallel to the plane have no useful intersection
    const RigidTransform to_panel = panel.pose.inverse();
    const Vec3f from = to_panel * aim.translation;
    const Vec3f along = to_panel.rotation * (aim.rotation * Vec3f(-Vec3f::UnitZ()));
    if (from.z() <= 0.0f || along.z() > -least) {
        return std::nullopt;
    }
    const float distance = from.z() / -along.z();
    const Vec3f where = from + distance * along;
    return QuadHit{0.5f + where.x() / panel.width, 0.5f - where.y() / panel.height, distance};
}

}  // namespace eti::hmd
