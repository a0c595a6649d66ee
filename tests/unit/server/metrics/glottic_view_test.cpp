// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/glottic_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/math/random.hpp"
#include "common/math/units.hpp"

namespace eti::metrics {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// An ellipsoid of `around` x `along` quads with bumps.
TriangleMesh ellipsoid(const Vec3f& centre, const Vec3f& radii, int around, int along, float bump) {
    TriangleMesh mesh;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i < around; ++i) {
            const float u = 2 * pi * static_cast<float>(i) / static_cast<float>(around);
            const float v = pi * static_cast<float>(j) / static_cast<float>(along);
            const float scale = 1.0f + bump * std::sin(7 * u) * std::sin(9 * v);
            mesh.vertices.push_back(
                centre + scale * radii.cwiseProduct(Vec3f(std::sin(v) * std::cos(u),
                                                          std::sin(v) * std::sin(u), std::cos(v))));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

/// Blends every vertex between the three frames with the nearest rest centres.
std::vector<SkinWeights> skin(const TriangleMesh& mesh, const std::vector<Vec3f>& centres) {
    std::vector<SkinWeights> weights;
    for (const Vec3f& p : mesh.vertices) {
        std::vector<std::uint16_t> order(centres.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            order[i] = static_cast<std::uint16_t>(i);
        }
        std::partial_sort(order.begin(), order.begin() + 3, order.end(),
                          [&](std::uint16_t a, std::uint16_t b) {
                              return (centres[a] - p).squaredNorm() < (centres[b] - p).squaredNorm();
                          });
        weights.push_back({{order[0], order[1], order[2], 0}, {0.5f, 0.3f, 0.2f, 0.0f}});
    }
    return weights;
}

/// A tunnel (the body, seen from inside), a tongue bulging into it and an epiglottis in front of a glottis.
struct Model {
    explicit Model(int detail) {
        Random random(5);
        for (int i = 0; i < 60; ++i) {
            patient.frame_rest_centre.push_back({0.03f * (random.uniform() - 0.5f),
                                                 0.03f * (random.uniform() - 0.5f),
                                                 0.14f * random.uniform() - 0.01f});
        }
        add(ellipsoid({0, 0, 0.05f}, {0.02f, 0.02f, 0.2f}, 2 * detail, 4 * detail, 0.03f), Tissue::soft);
        add(ellipsoid({0, -0.012f, 0.06f}, {0.012f, 0.01f, 0.03f}, detail, detail, 0.08f), Tissue::tongue);
        add(ellipsoid({0, -0.004f, 0.012f}, {0.006f, 0.004f, 0.001f}, detail / 2, detail / 2, 0.05f),
            Tissue::epiglottis);
        snapshot.proxy = {Quatf(Eigen::AngleAxisf(pi, Vec3f::UnitX())), {0.006f, -0.006f, 0.14f}};
        rest_pose();
    }

    void add(TriangleMesh mesh, Tissue tissue) {
        Surface surface;
        surface.tissue = tissue;
        surface.skin = skin(mesh, patient.frame_rest_centre);
        surface.triangle_tissue.assign(mesh.triangles.size(), tissue);
        surface.mesh = std::move(mesh);
        patient.surfaces.push_back(std::move(surface));
    }

    void rest_pose() {
        snapshot.frames.clear();
        for (const Vec3f& centre : patient.frame_rest_centre) {
            snapshot.frames.push_back({centre, Quatf::Identity()});
        }
        set_contour();
    }

    void deform(Random& random, float scale = 1.0f) {
        for (std::size_t i = 0; i < snapshot.frames.size(); ++i) {
            const Vec3f shift(random.normal(), random.normal(), random.normal());
            const Vec3f turn(random.normal(), random.normal(), random.normal());
            snapshot.frames[i].centre = patient.frame_rest_centre[i] + scale * 1.5e-3f * shift;
            snapshot.frames[i].rotation = quaternion_from(scale * 0.15f * turn);
        }
        set_contour();
    }

    void set_contour() {
        snapshot.landmarks.fill(Vec3f::Zero());
        snapshot.landmarks[static_cast<std::size_t>(Landmark::upper_gum)] = Vec3f(0, 0.01f, 0.35f);
        snapshot.glottis_contour.clear();
        for (int i = 0; i < 20; ++i) {
            const float u = 2 * pi * static_cast<float>(i) / 20;
            snapshot.glottis_contour.push_back({0.002f * std::cos(u), 0.003f * std::sin(u), 0.0f});
        }
    }

    patient::Patient patient;
    scene::Snapshot snapshot;
};

/// Independent of the code under test: all triangles skinned and displaced by the blade, plane and signed
/// areas in double precision.
bool hidden(const Model& model, const TriangleMesh& scope, const Vec3f& eye, const Vec3f& target,
            double tolerance) {
    const Vec3d o = eye.cast<double>();
    const Vec3d line = (target - eye).cast<double>();
    const auto crosses = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        const Vec3d normal = (b - a).cross(c - a);
        const double along = normal.dot(line);
        if (std::abs(along) < 1e-30) {
            return false;
        }
        const double t = normal.dot(a - o) / along;
        if (t <= 0.0 || t >= 1.0 - tolerance / line.norm()) {
            return false;
        }
        const Vec3d p = o + t * line;
        return normal.dot((b - a).cross(p - a)) >= 0 && normal.dot((c - b).cross(p - b)) >= 0 &&
               normal.dot((a - c).cross(p - c)) >= 0;
    };
    const PosedBladeClearanceDeformer give_way = blade_clearance_for(
        make_laryngoscope(Blade::miller_1), model.snapshot.proxy, model.snapshot.landmarks);
    for (const Surface& surface : model.patient.surfaces) {
        std::vector<Vec3d> now;
        for (std::size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
            Vec3d sum = Vec3d::Zero();
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                const std::uint16_t f = surface.skin[i].frame[k];
                const FramePose& frame = model.snapshot.frames[f];
                sum += static_cast<double>(surface.skin[i].weight[k]) *
                       (frame.rotation.cast<double>() *
                            (surface.mesh.vertices[i] - model.patient.frame_rest_centre[f]).cast<double>() +
                        frame.centre.cast<double>());
            }
            now.push_back(give_way(sum.cast<float>()).cast<double>());
        }
        for (const Triangle& t : surface.mesh.triangles) {
            if (crosses(now[t[0]], now[t[1]], now[t[2]])) {
                return true;
            }
        }
    }
    for (const Triangle& t : scope.triangles) {
        const auto at = [&](std::uint32_t i) {
            return Vec3d((model.snapshot.proxy * scope.vertices[i]).cast<double>());
        };
        if (crosses(at(t[0]), at(t[1]), at(t[2]))) {
            return true;
        }
    }
    return false;
}

TEST(SamplePolygon, PointsSampleAreaUniformly) {
    std::vector<Vec3f> contour;
    for (int i = 0; i < 16; ++i) {
        const float u = 2 * pi * static_cast<float>(i) / 16;
        contour.push_back({3 * std::cos(u), 1 * std::sin(u), 2});
    }
    const std::vector<Vec3f> samples = sample_polygon(contour, 80);
    EXPECT_EQ(samples.size(), 80u);
    float second_moment = 0.0f;
    for (const Vec3f& p : samples) {
        EXPECT_LT(p.x() * p.x() / 9 + p.y() * p.y(), 1.0f);
        EXPECT_NEAR(p.z(), 2.0f, 1e-5f);
        second_moment += p.x() * p.x() / 80;
    }
    // For an ellipse: a^2 / 4. The polygon's is smaller by 1 - (2 pi / 16)^2 / 6; the rest is the spiral's.
    EXPECT_NEAR(second_moment, 9.0f / 4, 0.05f * 9 / 4);
    EXPECT_TRUE(sample_polygon({}, 80).empty());
    EXPECT_EQ(sample_polygon(std::vector<Vec3f>(3, Vec3f::Ones()), 4), std::vector<Vec3f>(4, Vec3f::Ones()));
}

// A triangle with its apex in front, like the glottis, cut by straight edges in all directions; the reference
// is the area of the remaining polygon (Sutherland & Hodgman 1974).
TEST(SamplePolygon, CutAreaErrorIsBounded) {
    const std::vector<Vec3f> contour = {{0, 2.8f, 0}, {2, -2, 0}, {1, -2.7f, 0}, {-1, -2.7f, 0}, {-2, -2, 0}};
    const auto area = [](const std::vector<Vec3f>& polygon) {
        Vec3f sum = Vec3f::Zero();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            sum += 0.5f * polygon[i].cross(polygon[(i + 1) % polygon.size()]);
        }
        return sum.norm();
    };
    const std::vector<Vec3f> samples = sample_polygon(contour, GlotticViewer::Settings{}.samples);
    for (int turn = 0; turn < 72; ++turn) {
        const float u = 2 * pi * static_cast<float>(turn) / 72;
        const Vec3f normal(std::cos(u), std::sin(u), 0);
        for (float offset = -2.0f; offset < 2.01f; offset += 0.05f) {
            const auto beyond = [&](const Vec3f& p) { return normal.dot(p) - offset; };
            std::vector<Vec3f> left;
            for (std::size_t i = 0; i < contour.size(); ++i) {
                const Vec3f &a = contour[i], &b = contour[(i + 1) % contour.size()];
                if (beyond(a) > 0) {
                    left.push_back(a);
                }
                if ((beyond(a) > 0) != (beyond(b) > 0)) {
                    left.push_back(a + beyond(a) / (beyond(a) - beyond(b)) * (b - a));
                }
            }
            const auto seen = std::ranges::count_if(samples, [&](const Vec3f& p) { return beyond(p) > 0; });
            // An edge crosses the areas of some 14 of 160 points. Each then errs uniformly by up to half of
            // 0.6 points: together by 0.7, and hardly ever by 2.5.
            EXPECT_NEAR(100.0 * static_cast<double>(seen) / static_cast<double>(samples.size()),
                        100.0 * area(left) / area(contour), 2.5)
                << "turned by " << 5 * turn << " deg, at " << offset;
        }
    }
}

TEST(GlotticView, HalfOccludedGlottisIsHalfVisible) {
    patient::Patient patient;
    patient.frame_rest_centre = {Vec3f::Zero()};
    Surface screen;
    screen.mesh.vertices = {{0, -1, 0.1f}, {0, 1, 0.1f}, {-1, 0, 0.1f}};
    screen.mesh.triangles = {{0, 1, 2}};
    screen.skin.assign(3, SkinWeights{{0, 0, 0, 0}, {1, 0, 0, 0}});
    patient.surfaces = {screen};
    Model model(8);
    scene::Snapshot snapshot = model.snapshot;
    snapshot.frames = {FramePose{}};
    snapshot.proxy.translation = Vec3f(0, 0, 5);
    GlotticViewer viewer(patient, make_laryngoscope(Blade::miller_1));
    // The contour is symmetric about x = 0 and no sample lies on the axis.
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 50.0f, 0.01f);
    snapshot.frames[0].centre = {0.01f, 0, 0};
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 0.0f, 0.01f);
    snapshot.frames[0].centre = {-0.01f, 0, 0};
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 100.0f, 0.01f);
    // Within the tolerance in front of the glottis the screen is part of the rim.
    snapshot.frames[0].centre = {0.01f, 0, -0.0996f};
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 100.0f, 0.01f);
    snapshot.frames[0].centre = {0.01f, 0, -0.0994f};
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 0.0f, 0.01f);
}

/// An upper lip that hangs over the line of sight 0.2 m before the glottis: 40 mm wide, 30 mm long.
patient::Patient with_a_lip() {
    patient::Patient patient;
    patient.frame_rest_centre = {Vec3f::Zero()};
    Surface lip;
    constexpr int across = 20, along = 30;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i <= across; ++i) {
            lip.mesh.vertices.push_back(
                {2e-3f * static_cast<float>(i - across / 2), -2e-3f + 1e-3f * static_cast<float>(j), 0.2f});
        }
    }
    const auto corner = [](int i, int j) { return static_cast<std::uint32_t>(j * (across + 1) + i); };
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < across; ++i) {
            lip.mesh.triangles.push_back({corner(i, j), corner(i + 1, j), corner(i, j + 1)});
            lip.mesh.triangles.push_back({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
        }
    }
    lip.skin.assign(lip.mesh.vertices.size(), SkinWeights{{0, 0, 0, 0}, {1, 0, 0, 0}});
    patient.surfaces = {lip};
    return patient;
}

TEST(GlotticView, LipsInFrontOfGumDoNotOcclude) {
    const patient::Patient patient = with_a_lip();
    scene::Snapshot snapshot = Model(8).snapshot;
    snapshot.frames = {FramePose{}};
    snapshot.proxy.translation = Vec3f(0, 0, 5);
    const auto set = [&](Landmark which, const Vec3f& place) {
        snapshot.landmarks[static_cast<std::size_t>(which)] = place;
    };
    set(Landmark::upper_lip, {0, -0.002f, 0.2f});
    set(Landmark::lower_lip, {0, -0.012f, 0.2f});
    GlotticViewer viewer(patient, make_laryngoscope(Blade::miller_1));
    set(Landmark::upper_gum, {0, 0.006f, 0.21f});  // the lip lies between gum and glottis
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 0.0f, 0.01f);
    set(Landmark::upper_gum, {0, 0.006f, 0.19f});  // between eye and gum
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 100.0f, 0.01f);
    // Other objects occlude there, too: the laryngoscope's handle in front of the mouth.
    snapshot.proxy = {Quatf::Identity(), {0, -0.05f, 0.25f}};
    EXPECT_LT(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 50.0f);
}

TEST(GlotticView, MovedEyeSeesDifferentOpening) {
    // Half of the mouth is covered, 0.1 m before the glottis. An eye at 0.3 m that moves 10 mm sideways sees
    // 10 mm * 0.1 / 0.2 = 5 mm more or less of what lies there, more than the whole opening.
    patient::Patient patient;
    patient.frame_rest_centre = {Vec3f::Zero()};
    Surface screen;
    screen.mesh.vertices = {{0, -1, 0.1f}, {0, 1, 0.1f}, {-1, 0, 0.1f}};
    screen.mesh.triangles = {{0, 1, 2}};
    screen.skin.assign(3, SkinWeights{{0, 0, 0, 0}, {1, 0, 0, 0}});
    patient.surfaces = {screen};
    scene::Snapshot snapshot = Model(8).snapshot;
    snapshot.frames = {FramePose{}};
    snapshot.proxy.translation = Vec3f(0, 0, 5);
    GlotticViewer viewer(patient, make_laryngoscope(Blade::miller_1));
    EXPECT_NEAR(viewer.evaluate(snapshot, {0, 0, 0.3f}).opening_percent, 50.0f, 0.01f);
    EXPECT_NEAR(viewer.evaluate(snapshot, {0.01f, 0, 0.3f}).opening_percent, 100.0f, 0.01f);
    EXPECT_NEAR(viewer.evaluate(snapshot, {-0.01f, 0, 0.3f}).opening_percent, 0.0f, 0.01f);
}

TEST(GlotticView, TubeOccludesItsWidth) {
    patient::Patient patient;
    patient.frame_rest_centre = {Vec3f::Zero()};
    Model model(8);
    scene::Snapshot snapshot = model.snapshot;
    snapshot.frames = {FramePose{}};
    snapshot.proxy.translation = Vec3f(0, 0, 5);
    snapshot.tube_nodes = {{0, 0.05f, 0.1f}, {0, 0.001f, 0.1f}, {0, -0.001f, 0.1f}, {0, -0.05f, 0.1f}};
    GlotticViewer::Settings settings;
    settings.tube_radius = 0.0f;
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    EXPECT_NEAR(GlotticViewer(patient, scope, settings).evaluate(snapshot, {0, 0, 0.3f}).opening_percent,
                100.0f, 0.01f);
    settings.tube_radius = 1e-3f;
    // Seen from 0.3 m the tube at 0.1 m covers |x| < 1.5 mm of the ellipse of half-width 2 mm: by area
    // (2 / pi) (asin u + u sqrt(1 - u^2)) with u = 0.75; one column of samples is within 5 %.
    const float u = 0.75f;
    const float covered = 2 / pi * (std::asin(u) + u * std::sqrt(1 - u * u));
    EXPECT_NEAR(GlotticViewer(patient, scope, settings).evaluate(snapshot, {0, 0, 0.3f}).opening_percent,
                100 * (1 - covered), 5.0f);
}

// Reference: the bevel's closed form. Seen perpendicular to axis and left, a tube of radius r is a strip that
// ends at the tip on its right and two radii before it on its left.
TEST(SightLines, TubeEndOccludesUpToItsBevel) {
    constexpr float radius = 2e-3f, far = 1.0f;  // [m]; lines are parallel except for 8 mm a metre
    const Vec3f eye(0, 0, far), along = Vec3f::UnitX(), left = Vec3f::UnitY();
    Random random(3);
    std::vector<Vec3f> targets;
    for (int i = 0; i < 2000; ++i) {
        targets.emplace_back(radius * (6.0f * random.uniform() - 4.0f),
                             radius * (4.0f * random.uniform() - 2.0f), -1.1f * radius);
    }
    SightLines lines(eye, targets, 1e-6f);
    lines.block_by_cut_cylinder(lines.to_eye_frame(-3.0f * radius * along), lines.to_eye_frame(Vec3f::Zero()),
                                radius, lines.direction_in_eye_frame(along + left), -radius);
    int hidden = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const float x = targets[i].x() / radius, y = targets[i].y() / radius;
        const float inside = std::min({x + 3.0f, 1.0f - std::fabs(y), -1.0f - x - y});
        if (std::fabs(inside) > 0.02f) {  // lines converge by less than that
            EXPECT_EQ(lines.blocked(i), inside > 0.0f) << x << ' ' << y;
        }
        hidden += lines.blocked(i) ? 1 : 0;
    }
    EXPECT_GT(hidden, 200);
}

TEST(GlotticView, AgreesWithBruteForceOnDeformedSurfaces) {
    Model model(24);
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    const TriangleMesh mesh = laryngoscope_mesh(scope);
    GlotticViewer viewer(model.patient, scope);
    Random random(9);
    float lowest = 100.0f;
    float highest = 0.0f;
    for (int trial = 0; trial < 40; ++trial) {
        model.deform(random);
        model.snapshot.proxy.translation.x() = 0.01f * (random.uniform() - 0.5f);
        const Vec3f eye(0.008f * random.normal(), 0.006f + 0.006f * random.normal(), 0.24f);
        const GlotticView view = viewer.evaluate(model.snapshot, eye);
        const std::vector<Vec3f> samples =
            sample_polygon(model.snapshot.glottis_contour, GlotticViewer::Settings{}.samples);
        const auto seen = std::ranges::count_if(
            samples, [&](const Vec3f& sample) { return !hidden(model, mesh, eye, sample, 0.5e-3); });
        const float expected = 100.0f * static_cast<float>(seen) / static_cast<float>(samples.size());
        // A line within float round-off of a silhouette may fall on either side: two samples, 1.25 %.
        EXPECT_NEAR(view.opening_percent, expected, 1.3f) << "trial " << trial;
        lowest = std::min(lowest, expected);
        highest = std::max(highest, expected);
    }
    EXPECT_LT(lowest, 20.0f);
    EXPECT_GT(highest, 60.0f);
}

TEST(GlotticView, EpiglottisIsNotSeenThroughTongue) {
    Model model(24);
    GlotticViewer viewer(model.patient, make_laryngoscope(Blade::miller_1));
    model.snapshot.proxy.translation = Vec3f(0, 0, 5);
    const Vec3f above(0, 0.004f, 0.22f);
    const GlotticView open = viewer.evaluate(model.snapshot, above);
    EXPECT_GT(open.opening_percent, 0.0f);
    EXPECT_FALSE(open.epiglottis_seen) << "grades 1 and 2 do not ask for it";
    for (Vec3f& point : model.snapshot.glottis_contour) {
        point.y() -= 0.1f;  // behind everything
    }
    const GlotticView hidden = viewer.evaluate(model.snapshot, above);
    EXPECT_EQ(hidden.opening_percent, 0.0f);
    EXPECT_TRUE(hidden.epiglottis_seen);
    EXPECT_FALSE(viewer.evaluate(model.snapshot, {0, -0.3f, 0.06f}).epiglottis_seen);
}

}  // namespace
}  // namespace eti::metrics
