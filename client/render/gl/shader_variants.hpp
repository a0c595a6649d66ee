// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <string_view>

#include "client/render/gl/shader_program.hpp"

namespace eti::render {

/// Programs of the same sources with different defines, compiled on first use. Variants replace branches
/// because software rasterisers execute both sides of a branch.
class ShaderVariants {
  public:
    /// The data that the arguments refer to must outlive this object.
    ShaderVariants(std::string_view name, std::string_view vertex, std::string_view fragment)
        : name_(name), vertex_(vertex), fragment_(fragment) {}

    [[nodiscard]] ShaderProgram& variant(const ShaderProgram::Defines& defines) {
        const auto known = members_.find(defines);
        return known != members_.end()
                   ? known->second
                   : members_.try_emplace(defines, name_, defines, vertex_, fragment_).first->second;
    }

  private:
    std::string_view name_, vertex_, fragment_;
    std::map<ShaderProgram::Defines, ShaderProgram> members_;
};

}  // namespace eti::render
