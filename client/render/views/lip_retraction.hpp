// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/gl/shader_program.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::render {

/// Sets the lip retraction uniforms of a program built with the define RETRACT, which must be in use.
void apply(const LipRetraction& lips, ShaderProgram& program);

}  // namespace eti::render
