// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/annotation_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti::render {
namespace {

// Linear. Blue differs from tissue, liquid and the aids' traffic lights; a dark rim makes it visible on
// highlights.
const Eigen::Vector4f bright(0.04f, 0.50f, 1.0f, 1.0f), rim(0.0f, 0.01f, 0.03f, 1.0f);
constexpr float hidden = 0.3f;  // opacity of occluded parts

// Fractions of the picture's height: 3 and 13 pixels of 540.
constexpr float half_line = 0.0028f, ring = 0.012f, around = 0.0018f;
constexpr int ring_sides = 24;

// [m] offset towards the camera: the drawn surface is finer than the triangles that carry a mark.
constexpr float lift = 0.6e-3f;
constexpr float off_cut = 1.0e-3f;  // [m], tolerance for points on a section face

/// Clip-space triangles for lines of constant width in the picture.
class Ribbons {
  public:
    Ribbons(const DrawContext& context, float half_width, std::vector<Eigen::Vector4f>& into)
        : context_(context), half_width_(half_width), into_(into) {}

    void line(const Vec3f& a, const Vec3f& b) { clip_line(clipped(a), clipped(b)); }
    void circle(const Vec3f& centre, float radius) {
        const Eigen::Vector4f middle = clipped(centre);
        if (middle.w() <= least_w) {
            return;
        }
        const auto at = [&](int i) {
            const float turn =
                2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(ring_sides);
            return moved(middle, radius * Eigen::Vector2f(std::cos(turn), std::sin(turn)));
        };
        for (int i = 0; i < ring_sides; ++i) {
            clip_line(at(i), at(i + 1));
        }
    }
    void dot(const Vec3f& centre) {
        const Eigen::Vector4f middle = clipped(centre);
        if (middle.w() > least_w) {
            square(middle);
        }
    }

  private:
    static constexpr float least_w = 1e-4f;  // [m] in front of the camera

    [[nodiscard]] Eigen::Vector4f clipped(const Vec3f& point) const {
        const Vec3f way = context_.camera.eye - point;
        const float distance = way.norm();
        const float by = std::min(lift, 0.1f * distance);
        return context_.view_projection * Vec3f(point + by / std::max(distance, 1e-6f) * way).homogeneous();
    }
    /// `by`: fractions of the picture's height, to the right and up.
    [[nodiscard]] Eigen::Vector4f moved(const Eigen::Vector4f& from, const Eigen::Vector2f& by) const {
        Eigen::Vector4f to = from;
        to.x() += 2.0f * by.x() / context_.viewport.aspect() * from.w();
        to.y() += 2.0f * by.y() * from.w();
        return to;
    }
    void clip_line(const Eigen::Vector4f& a, const Eigen::Vector4f& b) {
        if (a.w() <= least_w || b.w() <= least_w) {
            return;
        }
        const Eigen::Vector2f scale(0.5f * context_.viewport.aspect(), 0.5f);
        const Eigen::Vector2f along = (b.head<2>() / b.w() - a.head<2>() / a.w()).cwiseProduct(scale);
        const float length = along.norm();
        if (length > 0.0f) {
            const Eigen::Vector2f side = half_width_ / length * Eigen::Vector2f(-along.y(), along.x());
            quad(moved(a, -side), moved(b, -side), moved(b, side), moved(a, side));
        }
        square(b);
    }
    // Also used for joins.
    void square(const Eigen::Vector4f& at) {
        const float h = half_width_;
        quad(moved(at, {-h, -h}), moved(at, {h, -h}), moved(at, {h, h}), moved(at, {-h, h}));
    }
    void quad(const Eigen::Vector4f& a, const Eigen::Vector4f& b, const Eigen::Vector4f& c,
              const Eigen::Vector4f& d) {
        into_.insert(into_.end(), {a, b, c, a, c, d});
    }

    const DrawContext& context_;
    float half_width_;
    std::vector<Eigen::Vector4f>& into_;
};

void add(Ribbons& ribbons, const DrawnMark& mark) {
    if (mark.annotation->kind == msg::ANNOTATION_POINT) {
        ribbons.circle(mark.points.front(), ring);
        ribbons.dot(mark.points.front());
        return;
    }
    ribbons.dot(mark.points.front());
    for (std::size_t i = 0; i + 1 < mark.points.size(); ++i) {
        ribbons.line(mark.points[i], mark.points[i + 1]);
    }
}

}  // namespace

std::vector<DrawnMark> drawn_marks(const View& view, const view::SceneView& scene, const Vantage& from) {
    std::vector<DrawnMark> marks;
    const LipRetraction lips = lip_retraction(from.eye.position(scene.landmarks()), scene.landmarks());
    const Eigen::Vector4f kept = from.section.plane(scene.landmarks()).kept();
    const auto add_mark = [&](const bus::Annotation& annotation) {
        DrawnMark mark{&annotation, {}};
        for (const SurfacePlace& place : annotation.places) {
            const auto where = view::current_position(scene, annotation.object, place);
            if (!where || (view.cut && kept.dot(where->homogeneous()) < -off_cut)) {
                continue;
            }
            const bool on_tissue = annotation.object != bus::laryngoscope_object;
            mark.points.push_back(view.lips_retracted && on_tissue ? lips.retract_lips(*where) : *where);
        }
        if (!mark.points.empty()) {
            marks.push_back(std::move(mark));
        }
    };
    for (const auto& [slot, annotation] : scene.annotations()) {
        add_mark(annotation);
    }
    if (from.sketch) {
        add_mark(*from.sketch);
    }
    return marks;
}

AnnotationPass::AnnotationPass()
    : program_("marks", {}, shaders::annotation_vertex, shaders::annotation_fragment) {}

void AnnotationPass::draw(const DrawContext& context) {
    if (context.ids()) {
        return;
    }
    const std::vector<DrawnMark> marks = drawn_marks(context.view, context.scene, context.from);
    if (marks.empty()) {
        return;
    }
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
    attribute(Attribute::position, 4, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector4f), 0);
    program_.use();
    glDisable(GL_CULL_FACE);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    // Overlapping pieces of a line are drawn once.
    glEnable(GL_STENCIL_TEST);
    glStencilMask(0xff);
    glClear(GL_STENCIL_BUFFER_BIT);
    glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    GLint layer = 0;
    for (const auto& [half_width, colour] :
         {std::pair{half_line + around, rim}, std::pair{half_line, bright}}) {
        vertices_.clear();
        Ribbons ribbons(context, half_width, vertices_);
        for (const DrawnMark& mark : marks) {
            add(ribbons, mark);
        }
        draw_vertices(colour, layer);
    }
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glEnable(GL_CULL_FACE);
}

void AnnotationPass::draw_vertices(const Eigen::Vector4f& colour, GLint& layer) {
    upload(GL_ARRAY_BUFFER, buffer_, vertices_, GL_STREAM_DRAW);
    for (const auto& [depths, opacity] : {std::pair{GL_GEQUAL, hidden}, std::pair{GL_LESS, 1.0f}}) {
        glDepthFunc(static_cast<GLenum>(depths));
        glStencilFunc(GL_NOTEQUAL, ++layer, 0xff);
        Eigen::Vector4f shown = colour;
        shown.w() *= opacity;
        program_.set("colour", shown);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
    }
}

}  // namespace eti::render
