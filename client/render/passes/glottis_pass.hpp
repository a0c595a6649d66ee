// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/draw_context.hpp"
#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"

namespace eti::render {

/// The glottic opening as a tinted pane, if the session requests it. It is occluded like any surface: its
/// visible fraction is the one that POGO measures. GL state: begin_passes(); reads the depth of opaque passes
/// and writes none.
class GlottisPass {
  public:
    GlottisPass();
    void draw(const DrawContext& context);

  private:
    ShaderProgram program_;
    VertexArray array_;
    Buffer vertices_;
};

}  // namespace eti::render
