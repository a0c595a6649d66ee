// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/render/draw_context.hpp"
#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"

namespace eti::render {

/// Marks of instructors and observers: rings and lines of constant width in pixels. Occluded parts are
/// drawn faintly. GL state: begin_passes(); reads the scene's depth, and leaves values in the stencil buffer,
/// which it clears first.
class AnnotationPass {
  public:
    AnnotationPass();
    void draw(const DrawContext& context);

  private:
    /// `layer`: stencil value; incremented.
    void draw_vertices(const Eigen::Vector4f& colour, GLint& layer);

    ShaderProgram program_;
    VertexArray array_;
    Buffer buffer_;
    std::vector<Eigen::Vector4f> vertices_;  ///< of triangles, in clip coordinates
};

/// Marks in a view's picture [m]: strokes and single points. Those removed by a section, or on objects
/// missing from the scene, are omitted.
struct DrawnMark {
    const bus::Annotation* annotation;
    std::vector<Vec3f> points;
};
[[nodiscard]] std::vector<DrawnMark> drawn_marks(const View& view, const view::SceneView& scene,
                                                 const Vantage& from);

}  // namespace eti::render
