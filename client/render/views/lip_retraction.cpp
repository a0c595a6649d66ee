// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/lip_retraction.hpp"

namespace eti::render {

void apply(const LipRetraction& lips, ShaderProgram& program) {
    Eigen::Matrix4f to_sight = Eigen::Matrix4f::Identity();
    to_sight.block<3, 3>(0, 0) = lips.axes;
    to_sight.block<3, 1>(0, 3) = -lips.axes * lips.origin;
    program.set("to_sight", to_sight);
    program.set("sight_up", Vec3f(lips.axes.row(1).transpose()));
    program.set("lip_shift", Eigen::Vector2f(lips.upper_shift, lips.lower_shift));
    program.set("lip_edge", Eigen::Vector2f(lips.upper_edge, lips.lower_edge));
    program.set("lip_shape", Eigen::Vector4f(LipRetraction::begins, LipRetraction::complete,
                                             LipRetraction::breadth, LipRetraction::gather));
}

}  // namespace eti::render
