// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "synthetic_scene.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/bus/codec/frame_pose.hpp"
#include "common/bus/codec/scene_object.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/skinning.hpp"
#include "common/model/attempt_metrics.hpp"

namespace eti::synthetic {
namespace {

using Field = std::function<float(const Vec3f&)>;

constexpr std::uint16_t trunk = 0, skull = 1, tongue = 2, epiglottis = 3;
constexpr float blade_length = 0.09f;

float ellipsoid(const Vec3f& p, const Vec3f& centre, const Vec3f& radii) {
    const Vec3f scaled = (p - centre).cwiseQuotient(radii);
    const float length = scaled.norm();
    const float gradient = scaled.cwiseQuotient(radii).norm();
    return gradient > 0.0f ? length * (length - 1.0f) / gradient : -radii.minCoeff();
}

float capsule(const Vec3f& p, const Vec3f& a, const Vec3f& b, float radius_a, float radius_b) {
    const Vec3f along = b - a;
    const float t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0f, 1.0f);
    return (p - a - t * along).norm() - (radius_a + t * (radius_b - radius_a));
}

TriangleMesh mesh_of(const Field& field, const Vec3f& low, const Vec3f& high, float spacing) {
    DistanceGrid grid;
    grid.origin = low;
    grid.spacing = spacing;
    for (int axis = 0; axis < 3; ++axis) {
        grid.size[static_cast<std::size_t>(axis)] = static_cast<int>((high[axis] - low[axis]) / spacing) + 2;
    }
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                grid.value.push_back(field(grid.node(x, y, z)));
            }
        }
    }
    return isosurface(grid, 0.0f);
}

float cavity(const Vec3f& p) {
    const Vec3f front(0.0f, -0.030f, 0.020f), throat(0.0f, 0.032f, 0.002f), glottis(0.0f, 0.042f, -0.027f),
        windpipe(0.0f, 0.046f, -0.10f);
    return std::min({capsule(p, front, throat, 0.012f, 0.011f), capsule(p, throat, glottis, 0.011f, 0.0035f),
                     capsule(p, glottis, windpipe, 0.003f, 0.003f)});
}

float body(const Vec3f& p) {
    const float head = ellipsoid(p, {0.0f, 0.040f, 0.030f}, {0.048f, 0.050f, 0.060f});
    const float neck = capsule(p, {0.0f, 0.045f, -0.02f}, {0.0f, 0.045f, -0.11f}, 0.030f, 0.030f);
    return std::max(std::min(head, neck), -cavity(p));
}

Tissue lining(const Vec3f& p) {
    if (cavity(p) > 1.5e-3f) {
        return Tissue::soft;
    }
    return p.z() < -0.034f ? Tissue::trachea : p.z() < -0.020f ? Tissue::larynx : Tissue::soft;
}

msg::SceneDescription surface(const std::string& name, Tissue tissue, const TriangleMesh& mesh,
                              std::uint16_t frame) {
    Surface surface{name, tissue, mesh, {}, {}};
    for (const Triangle& t : mesh.triangles) {
        const Vec3f centre = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0f;
        surface.triangle_tissue.push_back(tissue == Tissue::soft ? lining(centre) : tissue);
    }
    for (const Vec3f& vertex : mesh.vertices) {
        const bool on_skull = frame == trunk && vertex.z() > 0.0f;
        surface.skin.push_back({{on_skull ? skull : frame}, {1.0f}});
    }
    return bus::encode_surface(surface);
}

Landmarks make_landmarks() {
    Landmarks points;
    points.fill(Vec3f(0.0f, 0.03f, 0.0f));
    const auto set = [&](Landmark which, float y, float z) {
        points[static_cast<std::size_t>(which)] = Vec3f(0.0f, y, z);
    };
    set(Landmark::upper_gum, -0.005f, 0.020f);
    set(Landmark::lower_gum, 0.0f, 0.002f);
    set(Landmark::upper_lip, -0.010f, 0.026f);
    set(Landmark::lower_lip, -0.010f, 0.003f);
    set(Landmark::mouth_opening, -0.008f, 0.014f);
    set(Landmark::vallecula, 0.033f, -0.014f);
    set(Landmark::glottis, 0.042f, -0.027f);
    set(Landmark::glottis_anterior, 0.0392f, -0.027f);
    set(Landmark::glottis_posterior, 0.0448f, -0.027f);
    set(Landmark::oesophagus_inlet, 0.050f, -0.022f);
    set(Landmark::oesophagus_mid, 0.054f, -0.06f);
    set(Landmark::trachea_mid, 0.044f, -0.06f);
    set(Landmark::carina, 0.046f, -0.10f);
    return points;
}

}  // namespace

TriangleMesh body_mesh() {
    return mesh_of(body, {-0.06f, -0.02f, -0.15f}, {0.06f, 0.10f, 0.10f}, 2.5e-3f);
}

Scene make_scene() {
    Scene scene;
    scene.landmarks = make_landmarks();
    const Vec3f tongue_centre(0.0f, 0.016f, -0.002f), epiglottis_centre(0.0f, 0.037f, -0.014f);
    scene.rest_centres = {Vec3f::Zero(), Vec3f(0.0f, 0.05f, 0.0f), tongue_centre, epiglottis_centre};

    scene.objects.push_back(bus::encode_frames(scene.rest_centres));
    scene.objects.push_back(surface("body", Tissue::soft, body_mesh(), trunk));
    const auto ball = [](const Vec3f& centre, const Vec3f& radii, float spacing) {
        const Vec3f room = radii + Vec3f::Constant(2.0f * spacing);
        return mesh_of([&](const Vec3f& p) { return ellipsoid(p, centre, radii); }, centre - room,
                       centre + room, spacing);
    };
    scene.objects.push_back(
        surface("tongue", Tissue::tongue, ball(tongue_centre, {0.009f, 0.016f, 0.007f}, 1e-3f), tongue));
    scene.objects.push_back(surface("epiglottis", Tissue::epiglottis,
                                    ball(epiglottis_centre, {0.005f, 0.0018f, 0.006f}, 0.6e-3f), epiglottis));
    scene.objects.push_back(
        surface("skull", Tissue::skull, ball({0.0f, 0.045f, 0.055f}, {0.03f, 0.03f, 0.025f}, 3e-3f), skull));
    scene.objects.push_back(surface("spine", Tissue::spine,
                                    ball({0.0f, 0.062f, -0.05f}, {0.006f, 0.005f, 0.05f}, 1.5e-3f), trunk));

    const auto blade_field = [](const Vec3f& p) {
        return std::min(capsule(p, Vec3f::Zero(), {0.0f, 0.0f, blade_length - 3e-3f}, 3e-3f, 3e-3f),
                        capsule(p, Vec3f::Zero(), {0.0f, 0.10f, 0.0f}, 9e-3f, 9e-3f));
    };
    scene.objects.push_back(bus::encode_laryngoscope(
        mesh_of(blade_field, {-0.012f, -0.012f, -0.012f}, {0.012f, 0.112f, 0.093f}, 2e-3f)));

    Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    scope.blade_length = blade_length;
    scene.description = test::session_description(scene.landmarks, scope);
    for (msg::SceneDescription& object : scene.objects) {
        object.object_count(static_cast<std::uint32_t>(scene.objects.size()));
    }
    return scene;
}

msg::DeformationState deformation(const Scene& scene, std::uint64_t time_ns, float lift, float depth) {
    msg::DeformationState state;
    state.header().simulation_time_ns(time_ns);
    state.chunks(1);
    for (std::uint16_t f = 0; f < scene.rest_centres.size(); ++f) {
        FramePose pose{scene.rest_centres[f], Quatf::Identity()};
        if (f == tongue || f == epiglottis) {
            pose.centre.y() -= lift;
        }
        state.frames().push_back(bus::encode_frame_pose(f, pose));
    }
    const Vec3f mouth = at(scene.landmarks, Landmark::mouth_opening),
                glottis = at(scene.landmarks, Landmark::glottis);
    const Vec3f down = (at(scene.landmarks, Landmark::carina) - glottis).normalized();
    const Vec3f outside = mouth + Vec3f(-0.05f, -0.04f, 0.06f);
    // A polyline with a rounded corner at the mouth suffices as a tube's path.
    for (int i = 0; i <= 20; ++i) {
        const float t = static_cast<float>(i) / 20.0f;
        const Vec3f bent = (1 - t) * (1 - t) * outside +
                           2 * t * (1 - t) * (mouth + Vec3f(-0.006f, 0.020f, 0.0f)) + t * t * glottis;
        state.tube_nodes().push_back(bus::to_msg(bent));
    }
    state.tube_nodes().push_back(bus::to_msg(Vec3f(glottis + depth * down)));
    return state;
}

msg::ProxyState proxy(const Scene& scene, std::uint64_t time_ns) {
    const Vec3f mouth = at(scene.landmarks, Landmark::mouth_opening) + Vec3f(0.0f, -0.004f, 0.0f);
    const Vec3f tip = at(scene.landmarks, Landmark::vallecula);
    Mat3f axes;
    axes.col(2) = (tip - mouth).normalized();
    axes.col(0) = (-Vec3f::UnitY()).cross(axes.col(2)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    const Quatf rotation(axes);
    msg::ProxyState state;
    state.header().simulation_time_ns(time_ns);
    state.proxy(bus::to_msg(RigidTransform{rotation, tip - blade_length * Vec3f(axes.col(2))}));
    return state;
}

msg::LiveMetrics metrics(const Scene& scene, std::uint64_t time_ns, float glottic_opening_percent) {
    msg::LiveMetrics live;
    bus::set_runtime_parameters({}, live);
    live.header().simulation_time_ns(time_ns);
    live.attempt(1);
    live.attempt_running(true);
    bus::set_measures({.gum_force_n = 1.5f,
                       .glottic_opening_percent = glottic_opening_percent,
                       .tube_depth_past_glottis = 0.0f,
                       .tube_force_n = 0.25f},
                      live);
    for (const Vec3f& p : scene.landmarks) {
        live.landmarks().push_back(bus::to_msg(p));
    }
    return live;
}

void set(msg::LiveMetrics& message, float LiveMeasures::*measure, float value) {
    message.measures()[static_cast<std::size_t>(&live_measure(measure) - live_measure_fields.data())] = value;
}

AttemptMetrics manikin_metrics() {
    AttemptMetrics parameters = initial_metrics();
    for (const MetricField& field : metric_fields) {
        if (!depends_only_on_tool_poses(field)) {
            parameters.*field.value = std::numeric_limits<double>::quiet_NaN();
        }
    }
    return parameters;
}

msg::AttemptSummary summary(std::uint32_t attempt, bool success, std::uint64_t time_ns) {
    msg::AttemptSummary out;
    out.header().simulation_time_ns(time_ns);
    out.attempt(attempt);
    out.success(success);
    out.reason(success ? "the tube lies in the trachea" : "the tube lies in the oesophagus");
    for (const MetricField& field : metric_fields) {
        out.parameters().push_back(field.value == &AttemptMetrics::tube_speed_max_cm_per_s
                                       ? std::numeric_limits<double>::quiet_NaN()
                                       : static_cast<double>(out.parameters().size()));
    }
    return out;
}

msg::SessionStatus status(msg::SessionPhase phase) {
    msg::SessionStatus state;
    state.session("default");
    state.server("test:1");
    state.phase(phase);
    state.load(0.5f);
    return state;
}

void fill(view::SceneView& view, const Scene& scene) {
    view.apply(scene.description);
    for (const msg::SceneDescription& object : scene.objects) {
        view.apply(object);
    }
    view.apply(status(msg::PHASE_RUNNING));
    view.apply(deformation(scene, 1'000'000, 0.003f, 0.02f));
    view.apply(proxy(scene, 1'000'000));
    view.apply(metrics(scene, 1'000'000, 40.0f));
    view.update();
}

}  // namespace eti::synthetic
