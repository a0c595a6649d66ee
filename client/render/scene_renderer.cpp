// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "client/render/lip_retraction.hpp"
#include "client/render/shader_sources.hpp"

namespace eti::render {
namespace {

constexpr float cut_plane_x = 0.0f;     // [m], mid-sagittal
constexpr float cut_reach = 0.4f;       // [m], half of the cap's extent; hides behind the stencil
constexpr float shadow_radius = 0.15f;  // [m]
constexpr float ghost_opacity = 0.22f;  // of tools behind the cut

const Eigen::Vector4f no_clipping(0.0f, 0.0f, 0.0f, 1.0f);
const Eigen::Vector4f keep_right_half(-1.0f, 0.0f, 0.0f, cut_plane_x);

Eigen::Matrix4f matrix_of(const RigidTransform& pose) {
    Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
    matrix.block<3, 3>(0, 0) = pose.rotation.toRotationMatrix();
    matrix.block<3, 1>(0, 3) = pose.translation;
    return matrix;
}

Eigen::Vector4f flat(const std::array<std::uint8_t, 3>& colour) {
    return Eigen::Vector4f(colour[0], colour[1], colour[2], 255.0f) / 255.0f;
}

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

std::string lit(std::string_view body) {
    return std::string(source::mesh_inputs) + std::string(source::lighting) + std::string(body);
}

}  // namespace

struct SceneRenderer::Drawing {
    const View& view;
    const view::SceneView& scene;
    Camera camera;
    Eigen::Matrix4f view_projection;
    Lighting lighting;
    Eigen::Vector4f clip_plane;
    Viewport viewport;
    bool ids;
};

std::array<std::uint8_t, 3> object_colour(Tissue tissue) {
    return {static_cast<std::uint8_t>(20 * (static_cast<int>(tissue) + 1)), 0, 0};
}

SceneRenderer::SceneRenderer()
    : tissue_("tissue", {}, source::mesh_vertex, lit(source::tissue_fragment)),
      tissue_shadowed_("shadowed tissue", {"SHADOW"}, source::mesh_vertex, lit(source::tissue_fragment)),
      tissue_retracted_("tissue with lips held aside", {"RETRACT"}, source::mesh_vertex,
                        lit(source::tissue_fragment)),
      metal_("metal", {}, source::mesh_vertex, lit(source::metal_fragment)),
      tube_("tube", {"TUBE"}, source::mesh_vertex, lit(source::tube_fragment)),
      flat_("flat", {}, source::mesh_vertex, source::flat_fragment),
      flat_retracted_("flat with lips held aside", {"RETRACT"}, source::mesh_vertex, source::flat_fragment),
      flat_tube_("flat tube", {"TUBE"}, source::mesh_vertex, source::flat_fragment),
      cut_("cut", {}, source::cut_vertex, source::cut_fragment),
      vignette_("vignette", {}, source::vignette_vertex, source::vignette_fragment) {}

void SceneRenderer::sync(const view::SceneView& scene) {
    meshes_.sync(scene);
    if (liquid_.revision != scene.liquid_revision()) {
        liquid_.upload(scene.liquid(), scene.liquid_spacing());
        liquid_.revision = scene.liquid_revision();
    }
}

void SceneRenderer::draw(const View& view, const view::SceneView& scene, const Viewport& viewport,
                         const Vantage& from, Shading shading) {
    const Camera camera = view.camera(scene, from);
    const float aspect = static_cast<float>(viewport.width) / static_cast<float>(viewport.height);
    std::optional<Light> lamp;
    if (scene.laryngoscope_pose() && scene.keys()) {
        lamp = blade_lamp(*scene.laryngoscope_pose(), scene.keys()->laryngoscope().blade_length);
    }
    const bool ids = shading == Shading::object_id;
    const Vec3f background = ids ? Vec3f(Vec3f::Zero()) : view.background;
    const Drawing drawing{view,
                          scene,
                          camera,
                          camera.projection(aspect) * camera.view(),
                          view.lighting(camera, lamp),
                          view.cut ? keep_right_half : no_clipping,
                          viewport,
                          ids};
    if (view.skin == Skin::shadowed && !ids) {
        draw_shadows(drawing);
    }
    if (ids) {
        glDisable(GL_FRAMEBUFFER_SRGB);
    } else {
        glEnable(GL_FRAMEBUFFER_SRGB);
    }
    glViewport(viewport.x, viewport.y, viewport.width, viewport.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(viewport.x, viewport.y, viewport.width, viewport.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glEnable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glClearColor(background.x(), background.y(), background.z(), 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    if (view.cut) {
        // The cut faces first: they hide most of what lies behind them, all of the bones among it.
        draw_caps(drawing);
    }
    draw_skin(drawing);
    draw_tools(drawing, 1.0f);
    draw_liquid(drawing);
    if (view.cut && !ids) {
        glDepthFunc(GL_GREATER);
        draw_tools(drawing, ghost_opacity);
        glDepthFunc(GL_LESS);
    }
    if (view.vignette && !ids) {
        draw_vignette(drawing);
    }
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBindVertexArray(0);
}

void SceneRenderer::draw_liquid(const Drawing& drawing) {
    if (!drawing.ids) {
        const Viewport& area = drawing.viewport;
        liquid_.draw(drawing.camera, drawing.lighting, drawing.clip_plane, area.x, area.y, area.width,
                     area.height);
    }
}

void SceneRenderer::draw_shadows(const Drawing& drawing) {
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    shadow_map_.begin();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDisable(GL_CULL_FACE);
    // Slope-scaled bias against a surface shading itself; 4 steps cover half a texel's slope of 60 deg.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2.5f, 4.0f);
    flat_.use();
    flat_.set("view_projection",
              ShadowMap::clip_matrix(drawing.lighting.lights[0], drawing.camera.target, shadow_radius));
    flat_.set("clip_plane", no_clipping);
    flat_.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    for (SurfaceMesh& surface : meshes_.surfaces()) {
        if (!surface.bone) {
            surface.mesh.draw();
        }
    }
    if (meshes_.blade() && drawing.scene.laryngoscope_pose()) {
        flat_.set("model", matrix_of(*drawing.scene.laryngoscope_pose()));
        meshes_.blade()->draw();
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

ShaderProgram& SceneRenderer::skin_program(const Drawing& drawing) {
    if (drawing.view.skin == Skin::lips_aside) {
        return drawing.ids ? flat_retracted_ : tissue_retracted_;
    }
    if (drawing.ids) {
        return flat_;
    }
    return drawing.view.skin == Skin::shadowed ? tissue_shadowed_ : tissue_;
}

void SceneRenderer::draw_skin(const Drawing& drawing) {
    ShaderProgram& program = skin_program(drawing);
    program.use();
    program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    program.set("view_projection", drawing.view_projection);
    program.set("clip_plane", drawing.clip_plane);
    drawing.lighting.apply(program, drawing.camera.eye);
    if (drawing.view.skin == Skin::lips_aside) {
        apply(lip_retraction(drawing.camera.eye, drawing.scene.landmarks()), program);
    } else if (drawing.view.skin == Skin::shadowed && !drawing.ids) {
        program.set("shadow_map", 0);
        program.set("shadow_matrix",
                    ShadowMap::matrix(drawing.lighting.lights[0], drawing.camera.target, shadow_radius));
        glActiveTexture(GL_TEXTURE0);
        shadow_map_.bind_texture();
    }
    if (drawing.view.cut) {
        glEnable(GL_CLIP_DISTANCE0);
    }
    for (SurfaceMesh& surface : meshes_.surfaces()) {
        if (!surface.bone) {
            if (drawing.ids) {
                program.set("flat_colour", flat(object_colour(surface.tissue)));
            }
            surface.mesh.draw(
                surface.blocks.visible(drawing.view_projection, drawing.camera.eye, drawing.clip_plane));
        }
    }
    glDisable(GL_CLIP_DISTANCE0);
}

void SceneRenderer::draw_vignette(const Drawing& drawing) {
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    vignette_.use();
    vignette_.set("aspect",
                  static_cast<float>(drawing.viewport.width) / static_cast<float>(drawing.viewport.height));
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_BLEND);
}

void SceneRenderer::draw_caps(const Drawing& drawing) {
    glEnable(GL_STENCIL_TEST);
    glStencilMask(0xff);
    for (SurfaceMesh& surface : meshes_.surfaces()) {
        draw_cap(drawing, surface);
    }
    glScissor(drawing.viewport.x, drawing.viewport.y, drawing.viewport.width, drawing.viewport.height);
    glDisable(GL_STENCIL_TEST);
    glEnable(GL_CULL_FACE);
}

// A ray from the camera through the cut plane starts inside a closed surface when beyond the plane
// it leaves that surface once more than it enters it; the stencil counts that.
void SceneRenderer::draw_cap(const Drawing& drawing, SurfaceMesh& surface) {
    const auto& shape = drawing.scene.surfaces().at(surface.name);
    const auto band = section_band(shape.model().mesh.triangles, shape.vertices(), surface.colours,
                                   cut_plane_x, band_width(surface.tissue));
    const Viewport rim = pixels_of(band, drawing.view_projection, drawing.viewport);
    if (rim.width <= 0 || rim.height <= 0) {
        return;
    }
    glScissor(rim.x, rim.y, rim.width, rim.height);
    flat_.use();
    flat_.set("view_projection", drawing.view_projection);
    flat_.set("clip_plane", drawing.clip_plane);
    flat_.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    glEnable(GL_CLIP_DISTANCE0);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glStencilFunc(GL_ALWAYS, 0, 0xff);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    surface.mesh.draw(
        surface.blocks.visible(drawing.view_projection, drawing.camera.eye, drawing.clip_plane));
    glDisable(GL_CLIP_DISTANCE0);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    // Nothing lies between the camera and the plane but the tools, which come later.
    glDepthFunc(GL_ALWAYS);
    glStencilFunc(GL_NOTEQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    ShaderProgram& program = drawing.ids ? flat_ : cut_;
    program.use();
    program.set("view_projection", drawing.view_projection);
    program.set("flat_colour", flat(object_colour(surface.tissue)));
    program.set("fibre", surface.bone ? 0.06f : 0.22f);
    const VertexColour colour = opaque(cut_colour(surface.tissue));
    const auto corner = [&](float y, float z) { return CutVertex{Vec3f(cut_plane_x, y, z), colour}; };
    const float reach = cut_reach;
    cut_mesh_.draw(std::array<CutVertex, 6>{corner(-reach, -reach), corner(reach, -reach),
                                            corner(-reach, reach), corner(reach, -reach),
                                            corner(reach, reach), corner(-reach, reach)});
    if (!drawing.ids) {
        program.set("fibre", 0.0f);
        cut_mesh_.draw(band);
    }
    glDepthFunc(GL_LESS);
    glClear(GL_STENCIL_BUFFER_BIT);
}

void SceneRenderer::draw_tools(const Drawing& drawing, float opacity) {
    const bool ghost = opacity < 1.0f;
    glDepthMask(ghost ? GL_FALSE : GL_TRUE);
    if (ghost) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    }
    if (meshes_.blade() && drawing.scene.laryngoscope_pose()) {
        ShaderProgram& program = drawing.ids ? flat_ : metal_;
        program.use();
        program.set("model", matrix_of(*drawing.scene.laryngoscope_pose()));
        program.set("view_projection", drawing.view_projection);
        program.set("clip_plane", no_clipping);
        program.set("flat_colour", flat(blade_colour));
        program.set("opacity", opacity);
        drawing.lighting.apply(program, drawing.camera.eye);
        meshes_.blade()->draw();
    }
    if (meshes_.tube()) {
        ShaderProgram& program = drawing.ids ? flat_tube_ : tube_;
        program.use();
        program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
        program.set("view_projection", drawing.view_projection);
        program.set("clip_plane", no_clipping);
        program.set("flat_colour", flat(tube_colour));
        program.set("opacity", opacity);
        program.set("tube_length", drawing.scene.tube()->tube().length);
        drawing.lighting.apply(program, drawing.camera.eye);
        if (!drawing.ids) {
            glEnable(GL_BLEND);
            glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        }
        if (!drawing.ids && !ghost) {
            // Far wall first, so that it shows through the near one.
            glDepthMask(GL_FALSE);
            glCullFace(GL_FRONT);
            meshes_.tube()->draw();
            glCullFace(GL_BACK);
            glDepthMask(GL_TRUE);
        }
        meshes_.tube()->draw();
    }
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
}

}  // namespace eti::render
