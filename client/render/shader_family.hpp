// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <string>

#include "client/render/shader_program.hpp"

namespace eti::render {

/// Programs of the same sources with different defines, each made when it is first asked for: software
/// rasterisers compute both sides of a branch.
class ShaderFamily {
  public:
    ShaderFamily(std::string name, std::string vertex, std::string fragment)
        : name_(std::move(name)), vertex_(std::move(vertex)), fragment_(std::move(fragment)) {}

    [[nodiscard]] ShaderProgram& with(const ShaderProgram::Defines& defines) {
        const auto known = members_.find(defines);
        return known != members_.end()
                   ? known->second
                   : members_.try_emplace(defines, name_, defines, vertex_, fragment_).first->second;
    }

  private:
    std::string name_, vertex_, fragment_;
    std::map<ShaderProgram::Defines, ShaderProgram> members_;
};

}  // namespace eti::render
