// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/shader_program.hpp"
#include "common/model/lip_retraction.hpp"

namespace eti::render {

/// Holds lips aside in a program made with the define RETRACT, in use.
void apply(const LipRetraction& lips, ShaderProgram& program);

}  // namespace eti::render
