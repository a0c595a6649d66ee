// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include "client/render/camera.hpp"
#include "client/render/shader_program.hpp"
#include "common/model/landmark.hpp"

namespace eti::render {

/// Fingers hold the lips aside for the examiner, as the measured view of the glottis supposes (it
/// begins level with the upper gum). Display only: what lies before the gum is pushed off the line of
/// sight, upper lip and nose downwards in the picture, lower lip upwards; the simulated lips stay.
struct LipRetraction {
    Eigen::Matrix4f to_sight =
        Eigen::Matrix4f::Identity();  ///< world to (right, up, towards the eye from the gum) [m]
    Vec3f up = Vec3f::Zero();         ///< the picture's, in the world
    float upper_shift = 0.0f;         ///< [m], downwards
    float lower_shift = 0.0f;         ///< [m], upwards
    float upper_edge = 0.0f;          ///< [m], the upper lip's edge along `up`
    float lower_edge = 0.0f;

    /// For a program made with the define RETRACT, in use.
    void apply(ShaderProgram& program) const;
};

/// `sight`: from the eye onto the glottis.
[[nodiscard]] LipRetraction lip_retraction(const Camera& sight, const Landmarks& now);

}  // namespace eti::render
