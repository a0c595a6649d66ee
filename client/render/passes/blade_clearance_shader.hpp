// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "client/render/gl/shader_program.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::render {

/// GLSL of `vec3 give_way(vec3 point)`, the displaced position of a tissue point, world frame, as
/// BladeClearanceDeformer computes it. Prepend it to the shaders that call it; apply() sets its uniforms.
[[nodiscard]] std::string blade_clearance_source();

/// Sets the uniforms of a program built with that source, which must be in use. `placed`: deformer with the
/// laryngoscope's pose.
void apply(const PosedBladeClearanceDeformer& placed, ShaderProgram& program);

}  // namespace eti::render
