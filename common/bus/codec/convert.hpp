// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <time.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "common/math/transform.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// System clock [ns since 1970] for Header::send_time_ns; comparable between hosts with synchronised clocks.
[[nodiscard]] inline std::uint64_t wall_clock_ns() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000ULL +
           static_cast<std::uint64_t>(now.tv_nsec);
}

/// Header of a message about `simulation_time_ns`, sent now.
[[nodiscard]] inline eti::msg::Header make_header(std::uint64_t simulation_time_ns, std::uint32_t number) {
    eti::msg::Header header;
    header.simulation_time_ns(simulation_time_ns);
    header.send_time_ns(wall_clock_ns());
    header.number(number);
    return header;
}

[[nodiscard]] inline eti::msg::Vec3 to_msg(const Vec3f& v) {
    eti::msg::Vec3 out;
    out.x(v.x());
    out.y(v.y());
    out.z(v.z());
    return out;
}

[[nodiscard]] inline eti::msg::Quat to_msg(const Quatf& q) {
    eti::msg::Quat out;
    out.w(q.w());
    out.x(q.x());
    out.y(q.y());
    out.z(q.z());
    return out;
}

[[nodiscard]] inline eti::msg::Pose to_msg(const RigidTransform& pose) {
    eti::msg::Pose out;
    out.position(to_msg(pose.translation));
    out.orientation(to_msg(pose.rotation));
    return out;
}

[[nodiscard]] inline Vec3f from_msg(const eti::msg::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

/// Unit quaternion; the identity if the message's quaternion is too short or not finite.
[[nodiscard]] inline Quatf from_msg(const eti::msg::Quat& q) {
    const Quatf out(q.w(), q.x(), q.y(), q.z());
    const float norm = out.norm();
    return std::isfinite(norm) && norm > 1e-3f ? out.normalized() : Quatf::Identity();
}

[[nodiscard]] inline RigidTransform from_msg(const eti::msg::Pose& pose) {
    return {from_msg(pose.orientation()), from_msg(pose.position())};
}

using eti::is_valid_point;

[[nodiscard]] inline bool is_valid_point(const eti::msg::Vec3& v) {
    return is_valid_point(from_msg(v));
}

/// A received pose, its quaternion normalised; nullopt if it fails is_valid_pose().
[[nodiscard]] inline std::optional<RigidTransform> valid_pose(const eti::msg::Pose& pose,
                                                              float max_distance = max_coordinate) {
    const eti::msg::Quat& q = pose.orientation();
    const bool valid =
        is_valid_pose({Quatf(q.w(), q.x(), q.y(), q.z()), from_msg(pose.position())}, max_distance);
    return valid ? std::optional(from_msg(pose)) : std::nullopt;
}

}  // namespace eti::bus
