// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "client/app/session_input.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/math/random.hpp"
#include "server/app/output/bus_output.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"
#include "tests/support/bus_domain.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

constexpr int width = 800, height = 800;
// No other surface of a newborn has this tissue, so that its pixels are the opening's.
constexpr Tissue opening = Tissue::palate;

/// A newborn under the expert's blade at its best view, on the server's side and, over the bus, on the
/// client's.
class PictureAgainstRays : public ::testing::Test {
  protected:
    struct Session {
        Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
        patient::Patient patient = app::patient_of(scenario);
        scene::Snapshot snapshot;
        view::SceneView scene;
        metrics::GlotticViewer viewer{patient,
                                      make_laryngoscope(scenario.blade),
                                      {.samples = 800, .tube_radius = scenario.tube.outer_radius()}};
        render::HeadlessContext context;
        render::RenderTarget target{width, height, 1};
        render::SceneRenderer renderer{render::qualities().front()};
    };

    static void SetUpTestSuite() {
        session_ = new Session;
        lift();
        send();
    }
    static void TearDownTestSuite() { delete session_; }

    static void lift() {
        const Scenario& scenario = session_->scenario;
        scene::Inputs inputs = app::parked_inputs(scenario, session_->patient);
        app::Simulation simulation(scenario, session_->patient, inputs);
        const OperatorScript script = load_operator(find_data_file("expert", "operators"));
        app::LocalOperator hands(script, simulation.scope(), scenario.tube, script.seed,
                                 simulation.observation());
        hands.apply_to(inputs);
        simulation.scene().reset(inputs);
        float best = 0.0f;
        while (!hands.finished() && simulation.time() < 15.0 && best < 75.0f) {
            hands.advance(simulation.observation(), simulation.snapshot());
            hands.apply_to(inputs);
            simulation.step(inputs, std::nullopt);
            if (const float seen = simulation.observation().glottic_opening_percent; seen > best) {
                best = seen;
                session_->snapshot = simulation.snapshot();
            }
        }
    }

    static void send() {
        const Session& s = *session_;
        bus::Node server(test::bus_options("eti-server"));
        app::BusOutput output(server, s.scenario, s.patient, make_laryngoscope(s.scenario.blade),
                              s.scenario.runtime_parameters);
        bus::Node node(test::bus_options("eti-client"));
        client::SessionInput input(node, true, false);
        // After 45 states every frame has been resent.
        scene::Snapshot snapshot = s.snapshot;
        const auto limit = std::chrono::steady_clock::now() + 120s;
        for (int states = 0; states < 120 && std::chrono::steady_clock::now() < limit;) {
            snapshot.step += 2;
            snapshot.time_ns += 11'111'111;
            output.post(snapshot, {});
            output.post_live(snapshot, {});
            std::this_thread::sleep_for(20ms);
            input.receive_into(session_->scene);
            states += session_->scene.complete() ? 1 : 0;
        }
        // Haptic output is published separately.
        msg::ProxyState held;
        held.header(bus::make_header(snapshot.time_ns, static_cast<std::uint32_t>(snapshot.step)));
        held.proxy(bus::to_msg(snapshot.proxy));
        ASSERT_TRUE(session_->scene.apply(held));
        session_->scene.update();
    }

    /// Any object of the client's scene may carry the disc.
    struct SceneFrame {
        FrameMap map = frame_map(session_->scene.frames()[0], session_->patient.frame_rest_centre[0]);
    };

    /// The opening as a disc, as an additional object of the scene; it lies before the contour by the rays'
    /// tolerance.
    [[nodiscard]] static msg::SceneDescription disc(const Vec3f& eye) {
        constexpr float tolerance = metrics::GlotticViewer::Settings{}.tolerance;
        std::vector<Vec3f> points = session_->snapshot.glottis_contour;
        Vec3f centre = Vec3f::Zero();
        for (const Vec3f& p : points) {
            centre += p / static_cast<float>(points.size());
        }
        points.push_back(centre);
        msg::SceneDescription object;
        object.object("opening");
        object.kind(msg::OBJECT_SURFACE);
        object.object_count(static_cast<std::uint32_t>(session_->scene.surfaces().size()) + 2);
        object.tissue(static_cast<std::uint32_t>(opening));
        const SceneFrame carried;
        for (const Vec3f& p : points) {
            const Vec3f before = p + tolerance * (eye - p).normalized();
            const Vec3f rest = carried.map.linear.transpose() * (before - carried.map.offset);
            object.vertices().insert(object.vertices().end(), rest.data(), rest.data() + 3);
            object.skin_frame().insert(object.skin_frame().end(), frames_per_point, 0);
            object.skin_weight().push_back(65535);
            object.skin_weight().insert(object.skin_weight().end(), frames_per_point - 1, 0);
        }
        const auto count = static_cast<std::uint32_t>(points.size()) - 1;
        for (std::uint32_t i = 0; i < count; ++i) {
            std::uint32_t a = i, b = (i + 1) % count;
            if ((points[a] - centre).cross(points[b] - centre).dot(eye - centre) < 0.0f) {
                std::swap(a, b);
            }
            object.triangles().insert(object.triangles().end(), {count, a, b});
        }
        return object;
    }

    /// The eye's view, magnified so that the larynx fills the picture.
    [[nodiscard]] static render::Camera close_up(const view::SceneView& scene, const render::Vantage& from) {
        render::Camera camera = render::eye_camera(from.eye, scene.landmarks());
        camera.vertical_fov = 2.5f * degree;
        return camera;
    }

    [[nodiscard]] static int opening_pixels(const view::SceneView& scene, const render::Vantage& from) {
        Session& s = *session_;
        render::View close = *render::view_named("eye");
        close.cameras = [](const view::SceneView& seen, const render::Vantage& vantage) {
            return std::vector{close_up(seen, vantage)};
        };
        s.renderer.sync(scene);
        s.renderer.draw(close, scene, s.target, {0, 0, width, height}, from, render::Shading::object_id);
        const render::Image image = s.target.read();
        const auto colour = render::object_colour(opening);
        int pixels = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const std::uint8_t* const p = image.pixel(x, y);
                pixels += p[0] == colour[0] && p[1] == colour[1] && p[2] == colour[2] ? 1 : 0;
            }
        }
        return pixels;
    }

    /// Pixels of the unoccluded disc: the area of its image.
    [[nodiscard]] static float disc_pixels(const msg::SceneDescription& object,
                                           const render::Camera& camera) {
        const Eigen::Matrix4f matrix = camera.projection(1.0f) * camera.view();
        std::vector<Eigen::Vector2f> image;
        for (std::size_t v = 0; v + 3 < object.vertices().size(); v += 3) {  // without the centre
            const SceneFrame carried;
            const Vec3f rest(object.vertices()[v], object.vertices()[v + 1], object.vertices()[v + 2]);
            const Eigen::Vector4f clip = matrix * (carried.map * rest).homogeneous();
            image.emplace_back(0.5f * width * clip.x() / clip.w(), 0.5f * height * clip.y() / clip.w());
        }
        float twice = 0.0f;
        for (std::size_t i = 0; i < image.size(); ++i) {
            const Eigen::Vector2f &p = image[i], &q = image[(i + 1) % image.size()];
            twice += p.x() * q.y() - p.y() * q.x();
        }
        return 0.5f * std::abs(twice);
    }

    /// Share of the opening [%] visible in the trainee's picture.
    [[nodiscard]] static float pictured(const view::TraineeEye& eye) {
        const auto object = disc(eye.position(session_->scene.landmarks()));
        view::SceneView whole = session_->scene;
        EXPECT_TRUE(whole.apply(object));
        whole.update();
        const render::Vantage from{.eye = eye};
        const float all = disc_pixels(object, close_up(whole, from));
        EXPECT_GT(all, 2000.0f);
        return 100.0f * static_cast<float>(opening_pixels(whole, from)) / all;
    }

    [[nodiscard]] static float measured(const view::TraineeEye& eye) {
        return session_->viewer.evaluate(session_->snapshot, eye.position(session_->snapshot.landmarks))
            .opening_percent;
    }

    static Session* session_;
};

PictureAgainstRays::Session* PictureAgainstRays::session_ = nullptr;

TEST_F(PictureAgainstRays, VisibleShareMatchesForRandomEyes) {
    Random random(19);
    float lowest = 100.0f, highest = 0.0f;
    for (int i = 0; i < 12; ++i) {
        const Vec3f offset(10e-3f * random.normal(), 10e-3f * random.normal(), 30e-3f * random.normal());
        const view::TraineeEye eye(offset);
        const float rays = measured(eye), picture = pictured(eye);
        // 800 samples along a partly hidden rim: their steps are well under a per cent, pixels finer.
        EXPECT_NEAR(picture, rays, 3.0f) << "eye moved by " << 1e3f * offset.transpose() << " mm";
        lowest = std::min(lowest, rays);
        highest = std::max(highest, rays);
    }
    // Otherwise the poses would prove nothing.
    EXPECT_GT(highest, 50.0f);
    EXPECT_LT(lowest, highest - 20.0f);
}

TEST_F(PictureAgainstRays, VisibilityChangeMatchesForMovedEye) {
    const view::TraineeEye best;
    ASSERT_GT(measured(best), 50.0f);
    float most = 0.0f;
    for (const Vec3f& by :
         {Vec3f(10e-3f, 0, 0), Vec3f(-10e-3f, 0, 0), Vec3f(0, 10e-3f, 0), Vec3f(0, -10e-3f, 0)}) {
        const view::TraineeEye moved(by);
        const float rays = measured(moved) - measured(best), picture = pictured(moved) - pictured(best);
        EXPECT_NEAR(picture, rays, 3.0f) << 1e3f * by.transpose() << " mm";
        most = std::max(most, std::abs(rays));
    }
    EXPECT_GT(most, 5.0f);
}

}  // namespace
}  // namespace eti
