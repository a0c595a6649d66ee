// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/held_tool.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/tools.hpp"

namespace eti::client {
namespace {

// `gap` without so much of it as presses on in the direction of `lead`: half of `most` is free, and from
// there on less and less until nothing.
Vec3f yielding(const Vec3f& gap, const Vec3f& lead, float most) {
    const float size = lead.norm();
    const float free = std::clamp((most - size) / (0.5f * most), 0.0f, 1.0f);
    if (free >= 1.0f) {
        return gap;
    }
    const Vec3f direction = lead / size;
    const float pressing = std::max(0.0f, gap.dot(direction));
    return gap - (1.0f - free) * pressing * direction;
}

// By how much a hand that is too far ahead goes back within a `share` of the time that it takes.
Vec3f going_back(const Vec3f& lead, float most, float share) {
    const float size = lead.norm();
    return size > most ? Vec3f(-(size - most) / size * share * lead) : Vec3f(Vec3f::Zero());
}

}  // namespace

HeldTool::HeldTool(float length, float curvature, const RigidTransform& start, const HandLimits& limits)
    : length_(length),
      curvature_(curvature),
      limits_(limits),
      tip_(along_arc(curvature, length).translation),
      home_(start),
      pose_(start),
      wanted_(start) {}

void HeldTool::move(const Vec3f& way) {
    wanted_.translation += way;
}

void HeldTool::swing(const Vec3f& pivot, const Vec3f& arm, const Vec3f& way) {
    const Quatf turn = quaternion_from(arm.cross(way) / std::max(arm.squaredNorm(), 1e-6f));
    wanted_ = RigidTransform{turn, pivot - turn * pivot} * wanted_;
}

void HeldTool::swing_grip(const Vec3f& way) {
    const Vec3f tip = wanted_ * tip_;
    swing(tip, wanted_.translation - tip, way);
}

void HeldTool::swing_tip(const Vec3f& pivot, const Vec3f& way) {
    swing(pivot, wanted_ * tip_ - pivot, way);
}

void HeldTool::slide(float length) {
    wanted_ = wanted_ * along_arc(curvature_, length);
}

void HeldTool::lift(float length) {
    wanted_.translation += length * (wanted_.rotation * Vec3f::UnitY());
}

void HeldTool::turn(const Vec3f& angles) {
    const Vec3f tip = wanted_ * tip_;
    wanted_.rotation = (wanted_.rotation * quaternion_from(angles)).normalized();
    wanted_.translation = tip - wanted_.rotation * tip_;
}

float HeldTool::length_until(const Vec3f& point) const {
    return eti::length_until(curvature_, wanted_.inverse() * point);
}

Vec3f HeldTool::along(float length) const {
    return wanted_ * along_arc(curvature_, length).translation;
}

void HeldTool::hold_back(float dt, const Lead& lead) {
    const float share = std::min(1.0f, dt / limits_.give_way_time);
    pose_.translation += going_back(lead.way, limits_.lead, share);
    pose_.rotation =
        (quaternion_from(going_back(lead.turn, limits_.lead_turn, share)) * pose_.rotation).normalized();
    const Vec3f way = yielding(wanted_.translation - pose_.translation, lead.way, limits_.lead);
    const Vec3f turn = yielding(rotation_vector(wanted_.rotation * pose_.rotation.conjugate()), lead.turn,
                                limits_.lead_turn);
    wanted_ = {(quaternion_from(turn) * pose_.rotation).normalized(), pose_.translation + way};
    wanted_ = towards_wanted(std::min(1.0f, limits_.ahead / std::max(path(), 1e-9f)));
}

float HeldTool::path() const {
    return std::max((wanted_ * tip_ - pose_ * tip_).norm(), (wanted_.translation - pose_.translation).norm());
}

RigidTransform HeldTool::towards_wanted(float share) const {
    if (share >= 1.0f) {
        return wanted_;
    }
    const Quatf rotation = pose_.rotation.slerp(share, wanted_.rotation).normalized();
    const Vec3f tip = pose_ * tip_ + share * (wanted_ * tip_ - pose_ * tip_);
    return {rotation, tip - rotation * tip_};
}

void HeldTool::advance(float dt, const Lead& lead) {
    if (!(dt > 0.0f) || !lead.way.allFinite() || !lead.turn.allFinite()) {
        return;
    }
    hold_back(dt, lead);
    const float angle = rotation_vector(wanted_.rotation * pose_.rotation.conjugate()).norm();
    pose_ = towards_wanted(std::min(
        {1.0f, limits_.speed * dt / std::max(path(), 1e-9f), limits_.turning * dt / std::max(angle, 1e-9f)}));
}

}  // namespace eti::client
