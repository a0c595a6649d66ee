// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/shader_program.hpp"

namespace eti::render {

/// The glottic opening as a tinted pane, where the session asks for it. What covers it hides it: what of it
/// shines is the share that POGO counts.
class GlottisPass {
  public:
    GlottisPass();
    void draw(const Drawing& drawing);

  private:
    ShaderProgram program_;
    VertexArray array_;
    Buffer vertices_;
};

}  // namespace eti::render
