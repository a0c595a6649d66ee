// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "client/render/passes/annotation_pass.hpp"
#include "client/render/passes/caps_pass.hpp"
#include "client/render/passes/glottis_pass.hpp"
#include "client/render/passes/liquid/liquid_surface.hpp"
#include "client/render/passes/patient_pass.hpp"
#include "client/render/passes/room_pass.hpp"
#include "client/render/passes/shadow_pass.hpp"
#include "client/render/passes/tools_pass.hpp"
#include "client/render/views/lip_retraction.hpp"
#include "common/bus/security/session_keys.hpp"
#include "scene_picture.hpp"

namespace eti::render {
namespace {

using GlState = std::map<std::string, std::vector<GLint>>;

/// What begin_passes() promises, by name.
GlState gl_state() {
    GlState state;
    const auto on = [&](const char* name, GLenum what) { state[name] = {glIsEnabled(what)}; };
    on("scissor test", GL_SCISSOR_TEST);
    on("depth test", GL_DEPTH_TEST);
    on("stencil test", GL_STENCIL_TEST);
    on("culling", GL_CULL_FACE);
    on("blending", GL_BLEND);
    on("clip distance", GL_CLIP_DISTANCE0);
    on("point size", GL_PROGRAM_POINT_SIZE);
    on("polygon offset", GL_POLYGON_OFFSET_FILL);
    on("sRGB", GL_FRAMEBUFFER_SRGB);
    const auto get = [&](const char* name, GLenum what, std::size_t count) {
        glGetIntegerv(what, (state[name] = std::vector<GLint>(count)).data());
    };
    get("viewport", GL_VIEWPORT, 4);
    get("scissor box", GL_SCISSOR_BOX, 4);
    get("depth function", GL_DEPTH_FUNC, 1);
    get("culled faces", GL_CULL_FACE_MODE, 1);
    get("depth writes", GL_DEPTH_WRITEMASK, 1);
    get("colour writes", GL_COLOR_WRITEMASK, 4);
    get("framebuffer", GL_DRAW_FRAMEBUFFER_BINDING, 1);
    return state;
}

class PassState : public test::ScenePicture {
  protected:
    void SetUp() override {
        ScenePicture::SetUp();
        msg::LiveMetrics metrics = synthetic::metrics(source_, 2'000'000, 40.0f);
        RuntimeParameters live;
        live.view_glottis = 1.0f;
        bus::set_runtime_parameters(live, metrics);
        for (const Vec3f& point : {Vec3f(0, 0, 0), Vec3f(1e-3f, 0, 0), Vec3f(0, 0, 1e-3f)}) {
            metrics.glottis_contour().push_back(bus::to_msg(point));
        }
        ASSERT_TRUE(scene_.apply(metrics));
        msg::ShownAnnotation mark;
        mark.what().kind(msg::ANNOTATION_POINT);
        mark.what().object("tongue");
        mark.what().places().emplace_back();
        ASSERT_TRUE(scene_.apply(mark));
        scene_.update();
        meshes_.sync(scene_, Baking::wait);
        liquid_.upload(std::vector{at(scene_.landmarks(), Landmark::mouth_opening)}, 3e-3f);
        elsewhere_.upload(std::vector{Vec3f(0.0f, 0.0f, 40.0f)}, 3e-3f);
    }

    SceneMeshes meshes_;
    LiquidSurface liquid_, elsewhere_;
    CapsPass caps_;
    PatientPass patient_;
    RoomPass room_;
    ToolsPass tools_;
    GlottisPass glottis_;
    AnnotationPass annotations_;
    Vantage from_;
};

TEST_F(PassState, IsRestoredByEveryPass) {
    for (const Quality& quality : {qualities().front(), qualities().back()}) {
        ShadowPass shadows(quality);
        const RenderTarget target(test::width, test::height, quality.samples);
        for (const char* name : {"overview", "section"}) {
            for (const Shading shading : {Shading::lit, Shading::object_id_both_sides}) {
                const View& view = test::named(name);
                const Viewport area{16, 8, 200, 150};
                const Camera camera = view.camera(scene_, from_);
                const Light lamp = blade_lamp(*scene_.laryngoscope_pose(), 0.09f);
                const CutPlane cut = from_.section.plane(scene_.landmarks());
                const DrawContext context{
                    view,
                    scene_,
                    from_,
                    quality,
                    camera,
                    view.lighting(camera, lamp),
                    camera.projection(area.aspect()) * camera.view(),
                    view.cut ? cut.kept() : no_clipping,
                    cut,
                    lip_retraction(from_.eye.position(scene_.landmarks()), scene_.landmarks()),
                    area,
                    shading};
                shadows.draw(context, meshes_, liquid_);
                target.bind_scene();
                begin_passes(context);
                const GlState expected = gl_state();
                EXPECT_EQ(expected.at("scissor box"), (std::vector<GLint>{16, 8, 200, 150}));
                EXPECT_EQ(expected.at("clip distance"), std::vector<GLint>{0}) << "left by the shadow pass";
                const auto expect_restored = [&](const char* pass) {
                    EXPECT_EQ(gl_state(), expected) << pass << " in " << name << ", " << quality.name;
                };
                if (view.cut) {
                    caps_.draw(context, meshes_);
                    expect_restored("caps");
                }
                room_.draw_hands(context, meshes_, shadows);
                expect_restored("hands");
                patient_.draw(context, meshes_, shadows);
                expect_restored("patient");
                room_.draw(context, meshes_, shadows);
                expect_restored("room");
                tools_.draw(context, meshes_, shadows);
                expect_restored("tools");
                liquid_.draw(context, shadows);
                expect_restored("liquid");
                elsewhere_.draw(context, shadows);
                expect_restored("liquid out of sight");
                tools_.draw_hidden(context, meshes_, shadows);
                expect_restored("hidden tools");
                glottis_.draw(context);
                expect_restored("glottis");
                annotations_.draw(context);
                expect_restored("annotations");
            }
        }
    }
}

}  // namespace
}  // namespace eti::render
