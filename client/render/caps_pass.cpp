// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/caps_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/render/cut_shaders.hpp"
#include "client/render/mesh_shaders.hpp"
#include "client/view/pressed.hpp"

namespace eti::render {
namespace {

constexpr float cut_reach = 0.4f;  // [m], half of the cap's extent; hides behind the stencil

VertexColour opaque(const Vec3f& colour) {
    const auto byte = [](float value) { return static_cast<std::uint8_t>(std::lround(255.0f * value)); };
    return {byte(colour.x()), byte(colour.y()), byte(colour.z()), 255};
}

float band_width(Tissue tissue) {
    switch (tissue) {
        case Tissue::soft:
            return 1.1e-3f;
        case Tissue::tongue:
            return 0.8e-3f;
        default:
            return 0.25e-3f;
    }
}

// Body, then organs, then bones: organs lie over the body around them.
int layer(Tissue tissue) {
    return tissue == Tissue::soft ? 0 : is_bone(tissue) ? 2 : 1;
}

// The pixels that hold all of `vertices`, within the viewport.
Viewport pixels_of(const std::vector<CutVertex>& vertices, const Eigen::Matrix4f& view_projection,
                   const Viewport& viewport) {
    Eigen::Vector2f low(2.0f, 2.0f), high(-2.0f, -2.0f);
    for (const CutVertex& vertex : vertices) {
        const Eigen::Vector4f clip = view_projection * vertex.position.homogeneous();
        const Eigen::Vector2f place = clip.head<2>() / std::max(clip.w(), 1e-6f);
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    const auto pixel = [](float place, int side) {
        return static_cast<int>(std::clamp(0.5f * (place + 1.0f), 0.0f, 1.0f) * static_cast<float>(side));
    };
    const int left = std::max(pixel(low.x(), viewport.width) - 1, 0);
    const int bottom = std::max(pixel(low.y(), viewport.height) - 1, 0);
    const int right = std::min(pixel(high.x(), viewport.width) + 2, viewport.width);
    const int top = std::min(pixel(high.y(), viewport.height) + 2, viewport.height);
    return {viewport.x + left, viewport.y + bottom, right - left, top - bottom};
}

}  // namespace

CapsPass::CapsPass()
    : cut_("cut", {}, source::cut_vertex, source::cut_fragment),
      flat_("flat cut", {}, source::cut_vertex, source::flat_fragment) {}

void CapsPass::draw(const Drawing& drawing, const SceneMeshes& meshes) {
    glEnable(GL_STENCIL_TEST);
    glStencilMask(0xff);
    for (int at_layer = 0; at_layer < 3; ++at_layer) {
        for (const auto& [name, organ] : drawing.scene.surfaces()) {
            if (layer(organ.model().tissue) == at_layer) {
                draw_organ(drawing, organ, meshes.colours(name));
            }
        }
    }
    glScissor(drawing.viewport.x, drawing.viewport.y, drawing.viewport.width, drawing.viewport.height);
    glDisable(GL_STENCIL_TEST);
    glEnable(GL_CULL_FACE);
}

void CapsPass::draw_organ(const Drawing& drawing, const view::SkinnedSurface& organ,
                          const std::vector<VertexColour>& colours) {
    const Tissue tissue = organ.model().tissue;
    const CutPlane& plane = drawing.cut;
    const auto contour =
        section_contour(organ.model().mesh.triangles, view::pressed(drawing.scene, organ), colours, plane);
    if (contour.empty()) {
        return;
    }
    const auto band = section_band(contour, band_width(tissue));
    const Viewport rim = pixels_of(band, drawing.view_projection, drawing.viewport);
    if (rim.width <= 0 || rim.height <= 0) {
        return;
    }
    glScissor(rim.x, rim.y, rim.width, rim.height);
    flat_.use();
    flat_.set("view_projection", drawing.view_projection);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glStencilFunc(GL_ALWAYS, 0, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_INVERT);
    mesh_.draw(section_fan(contour));
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    // Nothing lies between the camera and the plane but the tools, which come later.
    glDepthFunc(GL_ALWAYS);
    glStencilFunc(GL_NOTEQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    ShaderProgram& program = drawing.ids() ? flat_ : cut_;
    program.use();
    program.set("view_projection", drawing.view_projection);
    program.set("flat_colour", flat(object_colour(tissue)));
    program.set("fibre", is_bone(tissue) ? 0.06f : 0.22f);
    const Vec3f across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
    const VertexColour colour = opaque(cut_colour(tissue));
    const auto corner = [&](float i, float j) {
        return CutVertex{contour.front().a.position + cut_reach * (i * across + j * along), colour};
    };
    mesh_.draw(
        std::array{corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, -1), corner(1, 1), corner(-1, 1)});
    if (!drawing.ids()) {
        program.set("fibre", 0.0f);
        mesh_.draw(band);
    }
    glDepthFunc(GL_LESS);
    glClear(GL_STENCIL_BUFFER_BIT);
}

}  // namespace eti::render
