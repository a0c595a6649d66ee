// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/lip_retraction.hpp"

#include <algorithm>

namespace eti::render {
namespace {

// How far [m] the lips' edges are kept from the line of sight: the gum's crest lies a sixth of the
// gap between the gums below it, some 3 mm; the lip goes just past the gum.
constexpr float upper_clearance = 5.0e-3f;
constexpr float lower_clearance = 9.0e-3f;

}  // namespace

LipRetraction lip_retraction(const Camera& sight, const Landmarks& now) {
    LipRetraction retraction;
    const Eigen::Matrix4f view = sight.view();
    retraction.to_sight = view;
    const Vec3f gum = (view * at(now, Landmark::upper_gum).homogeneous()).head<3>();
    retraction.to_sight(2, 3) -= gum.z();
    retraction.up = view.block<1, 3>(1, 0).transpose();
    const auto height = [&](Landmark which) { return (view * at(now, which).homogeneous()).y(); };
    retraction.upper_edge = height(Landmark::upper_lip);
    retraction.lower_edge = height(Landmark::lower_lip);
    retraction.upper_shift = std::max(0.0f, retraction.upper_edge + upper_clearance);
    retraction.lower_shift = std::max(0.0f, lower_clearance - retraction.lower_edge);
    return retraction;
}

void LipRetraction::apply(ShaderProgram& program) const {
    program.set("to_sight", to_sight);
    program.set("sight_up", up);
    program.set("lip_shift", Eigen::Vector2f(upper_shift, lower_shift));
    program.set("lip_edge", Eigen::Vector2f(upper_edge, lower_edge));
}

}  // namespace eti::render
