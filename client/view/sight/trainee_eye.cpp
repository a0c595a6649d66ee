// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/trainee_eye.hpp"

#include <algorithm>

namespace eti::view {
namespace {

Vec3f held(const Vec3f& offset) {
    return offset.cwiseMax(-TraineeEye::max_offset).cwiseMin(TraineeEye::max_offset);
}

/// Right, up and back axes for a look from `eye` to `target`.
Mat3f axes_of(const Vec3f& eye, const Vec3f& target) {
    const Vec3f way = eye - target;
    const Vec3f back = way.norm() > 1e-6f ? Vec3f(way.normalized()) : Vec3f::UnitZ();
    const Vec3f across = back.cross(Vec3f::UnitY());  // the patient's anterior is up
    const Vec3f right = across.norm() > 1e-4f ? across.normalized() : back.unitOrthogonal();
    Mat3f axes;
    axes.col(0) = right;
    axes.col(1) = back.cross(right);
    axes.col(2) = back;
    return axes;
}

}  // namespace

TraineeEye::TraineeEye(const Vec3f& offset) : offset_(held(offset)) {}

TraineeEye TraineeEye::from_headset(const RigidTransform& pose) {
    TraineeEye eye;
    eye.headset_pose_ = pose;
    return eye;
}

Vec3f TraineeEye::position(const Landmarks& now) const {
    return headset_pose_ ? headset_pose_->translation : Vec3f(best_eye(now) + offset_);
}

RigidTransform TraineeEye::pose(const Landmarks& now) const {
    if (headset_pose_) {
        return *headset_pose_;
    }
    const Vec3f eye = position(now);
    const Quatf straight(axes_of(eye, at(now, Landmark::glottis)));
    const Quatf aside =
        Quatf(Eigen::AngleAxisf(-right_, Vec3f::UnitY())) * Quatf(Eigen::AngleAxisf(up_, Vec3f::UnitX()));
    return RigidTransform::from((straight * aside).normalized(), eye);
}

void TraineeEye::move(const Vec3f& by, const Landmarks& now) {
    if (headset_pose_) {
        return;
    }
    const Vec3f glottis = at(now, Landmark::glottis);
    const Vec3f eye = position(now);
    const Vec3f wanted = held(offset_ + axes_of(eye, glottis) * by);
    const float distance = (best_eye(now) + wanted - glottis).norm();
    if (distance >= min_distance || distance >= (eye - glottis).norm()) {
        offset_ = wanted;
    }
}

void TraineeEye::turn(float right, float up) {
    if (headset_pose_) {
        return;
    }
    right_ = std::clamp(right_ + right, -max_gaze_turn, max_gaze_turn);
    up_ = std::clamp(up_ + up, -max_gaze_turn, max_gaze_turn);
}

}  // namespace eti::view
