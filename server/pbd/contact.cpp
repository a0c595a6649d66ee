// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact.hpp"

#include <algorithm>

namespace eti::pbd {

namespace {

Vec3f with_friction(const Vec3f& push, const Vec3f& slip, const Vec3f& normal, float friction) {
    const Vec3f tangential = slip - slip.dot(normal) * normal;
    const float length = tangential.norm();
    const float held = friction * push.norm();
    if (length < 1e-12f) {
        return push;
    }
    return push - tangential * (std::min(held, length) / length);
}

}  // namespace

float closest_on_segment(const Vec3f& a, const Vec3f& b, const Vec3f& point) {
    const Vec3f along = b - a;
    const float squared = along.squaredNorm();
    return squared > 0.0f ? std::clamp((point - a).dot(along) / squared, 0.0f, 1.0f) : 0.0f;
}

Vec3f push_out_of(const MovingCapsule& capsule, const Vec3f& before, const Vec3f& predicted, float radius,
                  float friction) {
    const float reach = capsule.radius + radius;
    const float t = closest_on_segment(capsule.a, capsule.b, predicted);
    const Vec3f axis = capsule.a + t * (capsule.b - capsule.a);
    const Vec3f axis_before = capsule.a_before + t * (capsule.b_before - capsule.a_before);
    const Vec3f from_before = before - axis_before;
    Vec3f apart = predicted - axis;
    float distance = apart.norm();
    // Swept over: the particle was on one side of the axis and has come out on the other.
    const bool crossed = distance < 2.0f * reach && from_before.dot(apart) < 0.0f;
    if (!crossed && distance >= reach) {
        return Vec3f::Zero();
    }
    if (crossed || distance < 1e-7f) {
        apart = from_before;
        distance = apart.norm();
        if (distance < 1e-7f) {
            apart = (capsule.b - capsule.a).unitOrthogonal();
            distance = 1.0f;
        }
        const Vec3f normal = apart / distance;
        const Vec3f push = axis + reach * normal - predicted;
        return push;
    }
    const Vec3f normal = apart / distance;
    const Vec3f push = (reach - distance) * normal;
    const Vec3f slip = (predicted + push - before) - (axis - axis_before);
    return with_friction(push, slip, normal, friction);
}

Vec3f push_out_of(const DistanceGrid& solid, const Vec3f& before, const Vec3f& predicted, float radius,
                  float friction) {
    const float distance = solid.distance(predicted);
    if (distance >= radius) {
        return Vec3f::Zero();
    }
    const Vec3f normal = solid.sample(predicted).normal;
    const Vec3f push = (radius - distance) * normal;
    return with_friction(push, predicted + push - before, normal, friction);
}

}  // namespace eti::pbd
