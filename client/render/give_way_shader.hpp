// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "client/render/shader_program.hpp"
#include "common/model/give_way.hpp"

namespace eti::render {

/// GLSL of `vec3 give_way(vec3 point)`, a point of the tissue in the world, as GiveWay has it. Goes before
/// what calls it; apply() sets its uniforms.
[[nodiscard]] std::string give_way_source();

/// For a program made with that source, in use. `tool`: the laryngoscope's pose.
void apply(const PlacedGiveWay& placed, ShaderProgram& program);

}  // namespace eti::render
