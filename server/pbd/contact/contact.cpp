// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/contact.hpp"

#include <algorithm>
#include <cmath>

namespace eti::pbd {

namespace {

Vec3f with_friction(const Vec3f& push, const Vec3f& slip, const Vec3f& normal, const Friction& friction) {
    const Vec3f tangential = slip - slip.dot(normal) * normal;
    const float length = tangential.norm();
    if (length < 1e-12f) {
        return push;
    }
    return push - tangential * static_cast<float>(friction.share(length, push.norm()));
}

/// End position of a point that hit the capsule at `met`, where the normal is `normal`, with `rest` [m] of
/// its displacement left: on this side of the capsule, after frictional slip, at most a quarter of the way
/// round.
Vec3f slid_along(const MovingCapsule& capsule, float reach, const Vec3f& met, const Vec3f& normal,
                 const Vec3f& rest, const Friction& friction) {
    const Vec3f push = -rest.dot(normal) * normal;
    Vec3f slip = rest + with_friction(push, rest, normal, friction);
    const float length = slip.norm();
    if (length > reach) {
        slip *= reach / length;
    }
    const Vec3f at = met + slip;
    const Vec3f away = offset_from_segment(capsule.a, capsule.b, at);
    const float distance = away.norm();
    return distance < reach && distance > 1e-7f ? Vec3f(at + (reach / distance - 1.0f) * away) : at;
}

}  // namespace

std::optional<Vec3f> first_contact(const Vec3f& a, const Vec3f& b, float reach, const Vec3f& from,
                                   const Vec3f& to) {
    constexpr int max_steps = 32;       // most are needed for grazing paths
    const float close = 1e-5f * reach;  // tolerance of contact
    Vec3f start = from;
    const Vec3f away = offset_from_segment(a, b, from);
    const float distance = away.norm();
    if (distance > 1e-7f && distance < reach) {
        start += (reach - distance) / distance * away;
    }
    const Vec3f displacement = to - start;
    const float length = displacement.norm();
    Vec3f at = start;
    float gone = 0.0f;
    for (int k = 0; k < max_steps; ++k) {
        const float gap = offset_from_segment(a, b, at).norm() - reach;
        if (gap < close) {
            return at;
        }
        gone += gap;
        if (gone >= length) {
            return std::nullopt;
        }
        at = start + (gone / length) * displacement;
    }
    return std::nullopt;
}

Vec3f pushed_clear(const Vec3f& a, const Vec3f& b, float reach, const Vec3f& point, const Vec3f& direction) {
    constexpr int max_steps = 32;  // each steps past a sphere about the axis
    Vec3f at = point;
    for (int k = 0; k < max_steps; ++k) {
        const Vec3f away = offset_from_segment(a, b, at);
        const float short_of = reach * reach - away.squaredNorm();
        if (short_of <= 1e-5f * reach * reach) {
            break;
        }
        const float ahead = away.dot(direction);
        at += (std::sqrt(ahead * ahead + short_of) - ahead) * direction;
    }
    return at;
}

bool runs_head_on(const Vec3f& moved, const Vec3f& normal, float reach) {
    const float length = moved.norm();
    return length > reach / 32.0f && moved.dot(normal) > 0.7f * length;
}

Vec3f push_out_of(const MovingCapsule& capsule, const Vec3f& before, const Vec3f& predicted, float radius,
                  const Friction& friction) {
    const float reach = capsule.radius + radius;
    const float t = closest_on_segment(capsule.a, capsule.b, predicted);
    const Vec3f axis = capsule.a + t * (capsule.b - capsule.a);
    const Vec3f axis_before = capsule.a_before + t * (capsule.b_before - capsule.a_before);
    const Vec3f apart = predicted - axis;
    const float distance = apart.norm();
    // Position before the step in the frame of the capsule's current position.
    const Vec3f moved = axis - axis_before;
    const Vec3f from = before + moved;
    const Vec3f displacement = predicted - from;
    const bool crossed = (from - axis).dot(apart) < 0.0f;
    if (crossed || displacement.squaredNorm() > reach * reach ||
        moved.squaredNorm() > reach * reach / 1024.0f) {
        const std::optional<Vec3f> met = first_contact(capsule.a, capsule.b, reach, from, predicted);
        if (met.has_value()) {
            const Vec3f normal = offset_from_segment(capsule.a, capsule.b, *met).normalized();
            const bool inwards = displacement.dot(normal) < 0.0f;
            if (inwards && distance < reach && runs_head_on(moved, normal, reach)) {
                return pushed_clear(capsule.a, capsule.b, reach, predicted, moved.normalized()) - predicted;
            }
            if (inwards && (distance >= reach || normal.dot(apart) < 0.0f)) {
                return slid_along(capsule, reach, *met, normal, predicted - *met, friction) - predicted;
            }
        }
    }
    if (distance >= reach) {
        return Vec3f::Zero();
    }
    if (distance < 1e-7f) {
        return reach * (capsule.b - capsule.a).unitOrthogonal();
    }
    const Vec3f normal = apart / distance;
    const Vec3f push = (reach - distance) * normal;
    const Vec3f slip = (predicted + push - before) - (axis - axis_before);
    return with_friction(push, slip, normal, friction);
}

Vec3f push_out_of(const DistanceGrid& solid, const Vec3f& before, const Vec3f& predicted, float radius,
                  const Friction& friction) {
    const float distance = solid.distance(predicted);
    if (distance >= radius) {
        return Vec3f::Zero();
    }
    const Vec3f normal = solid.sample(predicted).normal;
    const Vec3f push = (radius - distance) * normal;
    return with_friction(push, predicted + push - before, normal, friction);
}

}  // namespace eti::pbd
