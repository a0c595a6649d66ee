// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/render/drawing.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/shader_program.hpp"

namespace eti::render {

/// What instructors and observers point at and draw: rings and lines, as wide on every picture. Whatever
/// covers them they shine through faintly.
class AnnotationPass {
  public:
    AnnotationPass();
    void draw(const Drawing& drawing);

  private:
    /// `layer`: of the stencil; counted on.
    void draw_vertices(const Eigen::Vector4f& colour, GLint& layer);

    ShaderProgram program_;
    VertexArray array_;
    Buffer buffer_;
    std::vector<Eigen::Vector4f> vertices_;  ///< of triangles, as they are clipped
};

/// Where marks lie in a view's picture [m]: each stroke's points, and points alone. Those that a cut took
/// away, or that the scene does not have, are left out.
struct DrawnMark {
    const view::Annotation* annotation;
    std::vector<Vec3f> points;
};
[[nodiscard]] std::vector<DrawnMark> drawn_marks(const View& view, const view::SceneView& scene,
                                                 const Vantage& from);

}  // namespace eti::render
