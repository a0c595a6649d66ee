// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/bus/convert.hpp"
#include "common/bus/topics.hpp"

namespace eti::bus {

/// One message of each kind with every member set to a value of its own, sequences at their bounds.
template <class Message>
Message example();

inline msg::Header example_header() {
    msg::Header header;
    header.simulation_time_ns(0x0123456789abcdefULL);
    header.send_time_ns(0xfedcba9876543210ULL);
    header.number(77);
    return header;
}

inline msg::Vec3 vec(float first) {
    return to_msg(Vec3f{first, first + 0.25f, first + 0.5f});
}

inline msg::Pose example_pose(float first) {
    return to_msg(RigidTransform{quaternion_from({0.1f * first, 0.2f, -0.3f}), {first, -first, 0.5f}});
}

template <>
inline msg::SceneDescription example() {
    msg::SceneDescription out;
    out.object("tongue");
    out.header(example_header());
    out.object_count(9);
    out.kind(msg::OBJECT_TUBE);
    out.tissue(3);
    out.vertices({0.5f, 1.5f, -2.5f});
    out.triangles({1, 2, 70000});
    out.triangle_tissue({4, 5, 6, 7, 8});
    out.skin_frame({1, 2, 3, 65535});
    out.skin_weight({255, 0, 9});
    out.names({"incisor", "a", ""});
    out.outer_radius(0.25f);
    out.inner_radius(0.125f);
    return out;
}

template <>
inline msg::DeformationState example() {
    msg::DeformationState out;
    out.header(example_header());
    out.chunk(3);
    out.chunks(12);
    out.full(true);
    for (int i = 0; i < 48; ++i) {
        msg::FrameUpdate frame;
        frame.frame(static_cast<std::uint16_t>(i));
        frame.qw(-32767);
        frame.qx(static_cast<std::int16_t>(i));
        frame.qy(2);
        frame.qz(3);
        frame.x(0.5f);
        frame.y(static_cast<float>(i));
        frame.z(-1.0f);
        out.frames().push_back(frame);
    }
    for (int i = 0; i < 40; ++i) {
        out.tube_nodes().push_back(vec(static_cast<float>(i)));
    }
    return out;
}

template <>
inline msg::FluidState example() {
    msg::FluidState out;
    out.header(example_header());
    out.chunk(3);
    out.chunks(12);
    out.lower(vec(-1.5f));
    out.upper(vec(1.5f));
    out.spacing(0.001f);
    for (int i = 0; i < 576; ++i) {
        out.places().push_back(static_cast<std::uint16_t>(65535 - 7 * i));
    }
    return out;
}

template <>
inline msg::ToolPose example() {
    msg::ToolPose out;
    out.header(example_header());
    out.tool(1);
    out.pose(example_pose(2.0f));
    out.buttons(5);
    return out;
}

template <>
inline msg::EyePose example() {
    msg::EyePose out;
    out.header(example_header());
    out.pose(example_pose(3.0f));
    return out;
}

template <>
inline msg::ProxyState example() {
    msg::ProxyState out;
    out.header(example_header());
    out.device(example_pose(1.0f));
    out.proxy(example_pose(2.0f));
    out.last_free(example_pose(3.0f));
    out.velocity(vec(4.0f));
    out.angular_velocity(vec(5.0f));
    out.shell_force(vec(6.0f));
    out.shell_torque(vec(7.0f));
    for (int i = 0; i < 16; ++i) {
        msg::ShellContact contact;
        contact.position(vec(static_cast<float>(i)));
        contact.normal(vec(8.0f));
        contact.force(9.0f);
        contact.tissue(6);
        out.contacts().push_back(contact);
    }
    return out;
}

template <>
inline msg::TubeForce example() {
    msg::TubeForce out;
    out.header(example_header());
    out.force(vec(1.5f));
    out.torque(vec(-0.25f));
    return out;
}

template <>
inline msg::TissueContacts example() {
    msg::TissueContacts out;
    out.header(example_header());
    out.proxy(example_pose(1.0f));
    out.force(vec(1.0f));
    out.torque(vec(2.0f));
    out.dropped(3);
    for (int i = 0; i < 96; ++i) {
        msg::TissueContactPoint point;
        point.position(vec(static_cast<float>(i)));
        point.rest(vec(5.0f));
        point.force(vec(6.0f));
        point.radius(0.5f);
        point.tissue(2);
        out.contacts().push_back(point);
    }
    return out;
}

template <>
inline msg::Command example() {
    msg::Command out;
    out.header(example_header());
    out.sender("instructor");
    out.id(8);
    out.name("secretion");
    out.value(0.75f);
    return out;
}

template <>
inline msg::CommandResult example() {
    msg::CommandResult out;
    out.header(example_header());
    out.recipient("instructor");
    out.id(8);
    out.accepted(true);
    out.reason(std::string(200, 'r').c_str());
    return out;
}

template <>
inline msg::LiveMetrics example() {
    msg::LiveMetrics out;
    out.header(example_header());
    out.attempt(2);
    out.attempt_running(true);
    out.glottic_opening_percent(61.5f);
    out.gum_force_n(3.5f);
    out.tube_depth_past_glottis(-0.5f);
    out.tube_force_n(0.75f);
    out.tube_tip(vec(1.0f));
    out.live() = {0.25f, 0.5f, -0.125f, 0.875f, 1.25f, 9e3f, 2.0f, 1.0f};
    for (int i = 0; i < 32; ++i) {
        out.landmarks().push_back(vec(static_cast<float>(i)));
    }
    out.parameters().assign(static_cast<std::size_t>(msg::PARAMETER_COUNT), 1.25);
    out.message("lift along the handle");
    return out;
}

template <>
inline msg::AttemptSummary example() {
    msg::AttemptSummary out;
    out.header(example_header());
    out.attempt(4);
    out.success(true);
    out.reason("the tube lies in the trachea");
    out.parameters().assign(static_cast<std::size_t>(msg::PARAMETER_COUNT), -0.5);
    return out;
}

template <>
inline msg::SessionStatus example() {
    msg::SessionStatus out;
    out.session("test");
    out.header(example_header());
    out.phase(msg::PHASE_RUNNING);
    out.version("1.2.3");
    out.scenario("term");
    out.server("host:42");
    out.load(0.5f);
    out.behind_s(1.5f);
    out.late_steps(6);
    return out;
}

}  // namespace eti::bus
