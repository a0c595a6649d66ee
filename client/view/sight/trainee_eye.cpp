// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/trainee_eye.hpp"

#include <algorithm>

#include "common/math/axes.hpp"

namespace eti::view {
namespace {

const Vec3f anterior = -Vec3f::UnitY();

Vec3f held(const Vec3f& offset) {
    return offset.cwiseMax(-TraineeEye::max_offset).cwiseMin(TraineeEye::max_offset);
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
    const Quatf straight(view_axes(eye, at(now, Landmark::glottis), anterior));
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
    const Vec3f wanted = held(offset_ + view_axes(eye, glottis, anterior) * by);
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
