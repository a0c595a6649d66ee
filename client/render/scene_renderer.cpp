// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

namespace eti::render {
namespace {

// The i-th of `count` side-by-side parts of an area.
Viewport part_of(const Viewport& area, int i, int count) {
    const int left = area.width * i / count, right = area.width * (i + 1) / count;
    return {area.x + left, area.y, right - left, area.height};
}

// Breath fogs a cold lens; the lamp warms it.
ToneMapping tone_of(const View& view, const view::SceneView& scene, const Vantage& from) {
    constexpr double warming = 20.0;  // [s], time constant of clearing
    ToneMapping tone = view.tone;
    if (view.lens) {
        const double seconds = 1e-9 * static_cast<double>(scene.simulation_time_ns());
        tone.fogging =
            std::max(tone.fogging, from.fogging * static_cast<float>(std::exp(-seconds / warming)));
    }
    return tone;
}

std::optional<Light> lamp_of(const view::SceneView& scene) {
    if (scene.laryngoscope_pose() && scene.keys()) {
        return blade_lamp(*scene.laryngoscope_pose(), scene.keys()->laryngoscope().blade_length);
    }
    return std::nullopt;
}

}  // namespace

std::array<std::uint8_t, 3> object_colour(Tissue tissue) {
    return {tissue_label(tissue), 0, 0};
}

std::array<std::uint8_t, 3> back_colour(Tissue tissue) {
    return {object_colour(tissue)[0], 0, 128};
}

void begin_passes(const DrawContext& context) {
    const Viewport& area = context.viewport;
    glViewport(area.x, area.y, area.width, area.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(area.x, area.y, area.width, area.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glEnable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    const Vec3f background = context.ids() ? Vec3f(Vec3f::Zero()) : context.view.background;
    glClearColor(background.x(), background.y(), background.z(), 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
}

void place(ShaderProgram& program, const DrawContext& context, const Eigen::Matrix4f& model,
           const Eigen::Vector4f& clip_plane) {
    program.set("model", model);
    program.set("view_projection", context.view_projection);
    program.set("clip_plane", clip_plane);
}

SceneRenderer::SceneRenderer(const Quality& quality) : quality_(quality), shadows_(quality) {
    if (quality.environment) {
        environment_.emplace();
    }
}

void SceneRenderer::sync(const view::SceneView& scene, Baking baking) {
    loss_.throw_if_lost();
    meshes_.sync(scene, baking);
    if (liquid_.revision != scene.liquid_revision()) {
        liquid_.upload(scene.liquid(), scene.liquid_spacing(), scene.liquid_detail(), scene.liquid_kind());
        liquid_.revision = scene.liquid_revision();
    }
    if (meshes_.ready()) {
        film_.update(scene.simulation_time_ns(), meshes_.patient(), liquid_);
    }
}

void SceneRenderer::draw(const View& view, const view::SceneView& scene, const RenderTarget& target,
                         const Viewport& area, const Vantage& from, Shading shading) {
    const std::vector<Camera> cameras = view.cameras(scene, from);
    const std::optional<Light> lamp = lamp_of(scene);
    const CutPlane cut = from.section.plane(scene.landmarks());
    const ToneMapping tone = tone_of(view, scene, from);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const Viewport part = part_of(area, static_cast<int>(i), static_cast<int>(cameras.size()));
        const Camera& camera = cameras[i];
        Lighting lighting = view.lighting(camera, lamp);
        if (environment_ && !view.cut && !view.lens) {
            lighting.environment = &*environment_;
        }
        const DrawContext context{view,
                                  scene,
                                  from,
                                  quality_,
                                  camera,
                                  lighting,
                                  camera.projection(part.aspect()) * camera.view(),
                                  view.cut ? cut.kept() : no_clipping,
                                  cut,
                                  lip_retraction(from.eye.position(scene.landmarks()), scene.landmarks()),
                                  part,
                                  shading};
        if (meshes_.ready() && !context.ids()) {
            shadows_.draw(context, meshes_, liquid_);
        }
        target.bind_scene();
        begin_passes(context);
        if (meshes_.ready()) {
            for (const Pass pass : view.passes) {
                run(pass, context);
            }
        }
        glDisable(GL_SCISSOR_TEST);
        glBindVertexArray(0);
        target.resolve(part);
        context.ids() ? tone_.copy(target, part) : tone_.draw(target, part, tone, view.background);
    }
}

void SceneRenderer::run(Pass pass, const DrawContext& context) {
    switch (pass) {
        case Pass::room_shadow:
        case Pass::lamp_shadow:
            break;  // drawn before, into maps of their own
        case Pass::caps:
            caps_.draw(context, meshes_);
            break;
        case Pass::patient:
            patient_.draw(context, meshes_, shadows_);
            break;
        case Pass::hands:
            room_.draw_hands(context, meshes_, shadows_);
            break;
        case Pass::room:
            room_.draw(context, meshes_, shadows_);
            break;
        case Pass::tools:
            tools_.draw(context, meshes_, shadows_);
            break;
        case Pass::liquid:
            if (!context.ids()) {
                liquid_.draw(context, shadows_);
            }
            break;
        case Pass::glottis:
            glottis_.draw(context);
            break;
        case Pass::annotations:
            annotations_.draw(context);
            break;
        case Pass::hidden_tools:
            tools_.draw_hidden(context, meshes_, shadows_);
            break;
    }
}

}  // namespace eti::render
