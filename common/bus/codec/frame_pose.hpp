// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/mesh/skinning.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// One in the quaternion of a FrameUpdate.
inline constexpr float quaternion_unit = 32767.0f;

[[nodiscard]] inline msg::FrameUpdate encode_frame_pose(std::uint16_t frame, const FramePose& pose) {
    const auto quantised = [](float x) {
        return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * quaternion_unit));
    };
    msg::FrameUpdate update;
    update.frame(frame);
    update.qw(quantised(pose.rotation.w()));
    update.qx(quantised(pose.rotation.x()));
    update.qy(quantised(pose.rotation.y()));
    update.qz(quantised(pose.rotation.z()));
    update.x(pose.centre.x());
    update.y(pose.centre.y());
    update.z(pose.centre.z());
    return update;
}

/// The pose, its quaternion normalised; nullopt if it fails is_valid_pose().
[[nodiscard]] inline std::optional<FramePose> decode_frame_pose(const msg::FrameUpdate& update) {
    const auto part = [](std::int16_t value) { return static_cast<float>(value) / quaternion_unit; };
    const Quatf rotation(part(update.qw()), part(update.qx()), part(update.qy()), part(update.qz()));
    const Vec3f centre(update.x(), update.y(), update.z());
    return is_valid_pose({rotation, centre}) ? std::optional(FramePose{centre, rotation.normalized()})
                                             : std::nullopt;
}

}  // namespace eti::bus
